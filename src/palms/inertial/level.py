"""The phone's attitude in level axes (z up), from the gyroscope or from the platform."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from palms.errors import InputError
from palms.geometry import FloatArray
from palms.inertial.log import RATE_HZ, InertialLog
from palms.inertial.settings import InertialSettings

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = ["level_attitude", "level_axis"]

_UP = np.array([0.0, 0.0, 1.0])


def level_attitude(log: InertialLog, settings: InertialSettings) -> Rotation:
    """Return what turns vectors of the phone's axes into level ones, at each time.

    From the gyroscope: its rates are integrated, and acceleration is averaged in axes that do
    not turn with the phone. A walker goes nowhere but ahead, so what remains is gravity, however
    the phone swings. About the vertical the first attitude is arbitrary and slowly goes
    astray. From the platform: as it is.

    Parameters
    ----------
    log : InertialLog
        At `RATE_HZ`.
    settings : InertialSettings
        `heading` chooses; where that sensor is missing the other serves.

    Returns
    -------
    scipy Rotation
        N of them.

    Raises
    ------
    InputError
        When the log has neither rates nor attitudes.

    Examples
    --------
    >>> on_its_side = np.tile([9.81, 0, 0], (200, 1))
    >>> log = InertialLog(np.arange(200) / 50, on_its_side, rate_rad_s=np.zeros((200, 3)))
    >>> level_attitude(log, InertialSettings())[0].apply([1, 0, 0]).round(6).tolist()
    [0.0, 0.0, 1.0]
    """
    from scipy.ndimage import gaussian_filter1d
    from scipy.spatial.transform import Rotation

    if log.attitude is not None and (settings.heading == "attitude" or log.rate_rad_s is None):
        return Rotation.from_quat(_unit(log.attitude))
    if log.rate_rad_s is None:
        raise InputError(
            "inertial log", expected="a gyroscope or the platform's rotation vector",
            got="neither", fix="switch one of them on before you record",
        )  # fmt: skip
    turned = _running_product(Rotation.from_rotvec(log.rate_rad_s / RATE_HZ))
    felt = turned.apply(np.array(log.acceleration_m_s2))  # scipy takes no read-only arrays
    up = gaussian_filter1d(felt, 0.5 * settings.gravity_s * RATE_HZ, axis=0, mode="nearest")
    return _raising(up) * turned


def level_axis(attitude: Rotation) -> FloatArray:
    """Return the phone's axis (3,) that stayed most level: what its heading is read from.

    Where it points at first does not matter, as long as it goes around with the phone.

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> upright = Rotation.from_euler("x", [[90], [80], [85]], degrees=True)
    >>> abs(level_axis(upright)).round(3).tolist()
    [1.0, 0.0, 0.0]
    """
    up = attitude.inv().apply(_UP)
    axis: FloatArray = np.linalg.eigh(up.T @ up)[1][:, 0]
    return np.asarray(axis * np.sign(axis[np.abs(axis).argmax()]))


def _unit(quaternions: FloatArray) -> FloatArray:
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    if (length < 0.1).any():
        raise InputError(
            "inertial log", expected="attitudes as unit quaternions",
            got=f"one of length {length.min():.2g}", fix="record it again",
        )  # fmt: skip
    return np.asarray(quaternions / length)


def _running_product(turns: Rotation) -> Rotation:
    """Attitude (N,) after each turn about the phone's own axes, in log2(N) rounds."""
    from scipy.spatial.transform import Rotation

    shift, product = 1, turns
    while shift < len(product):
        product = Rotation.concatenate([product[:shift], product[:-shift] * product[shift:]])
        shift *= 2
    return product


def _raising(directions: FloatArray) -> Rotation:
    """Shortest rotations (N,) that turn directions upright."""
    from scipy.spatial.transform import Rotation

    unit = directions / np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), 1e-9)
    # half way between a direction and the vertical lies the axis of a half turn to it
    quaternion = np.column_stack([unit[:, 1], -unit[:, 0], np.zeros(len(unit)), 1 + unit[:, 2]])
    upside_down = quaternion[:, 3] < 1e-6
    quaternion[upside_down] = [1.0, 0.0, 0.0, 0.0]
    return Rotation.from_quat(quaternion)
