"""TLS: a certificate that is given, or one that the server signs itself and keeps."""

from __future__ import annotations

import datetime
import ipaddress
import os
import socket
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from palms.errors import InputError, PalmsError
from palms.io.files import make_folder, write_bytes

if TYPE_CHECKING:
    from cryptography import x509

__all__ = ["Certificate", "given", "own_names", "self_signed"]

VALID_DAYS = 397  # what browsers accept
RENEW_DAYS = 30


class Certificate(NamedTuple):
    """Files of a certificate and its key, and the certificate's SHA-256 to compare by eye."""

    certificate: Path
    key: Path
    fingerprint: str


def given(certificate: Path, key: Path) -> Certificate:
    """Return a certificate that the user has.

    Raises
    ------
    InputError
        When the two do not fit, or cannot be read.
    """
    import ssl

    try:
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        context.load_cert_chain(certificate, key)
        text = certificate.read_text("ascii")
        first = text[text.index("-----BEGIN") : text.index("-----END") + 25]
        return Certificate(certificate, key, _fingerprint(ssl.PEM_cert_to_DER_cert(first.strip())))
    except (OSError, ValueError) as error:
        raise InputError(
            str(certificate), expected="a certificate in PEM and its key", fix="check both files",
            got=getattr(error, "strerror", None) or str(error),
        ) from None  # fmt: skip


def self_signed(folder: Path, names: tuple[str, ...]) -> Certificate:
    """Return a certificate signed by itself, made anew when its time or its names are over.

    Parameters
    ----------
    folder : Path
        Where it is kept.
    names : tuple of str
        Names and addresses of this server.

    Raises
    ------
    PalmsError
        When the package cryptography is missing.
    """
    try:
        from cryptography import x509
        from cryptography.hazmat.primitives.serialization import Encoding
    except ImportError:
        raise PalmsError(
            "--tls", expected="the package cryptography", got="none",
            fix='pip install "palms-localization[server]"',
        ) from None  # fmt: skip
    place = make_folder(folder / "tls")
    place.chmod(0o700)
    certificate, key = place / "certificate.pem", place / "key.pem"
    wanted = tuple(sorted({"localhost", "127.0.0.1", "::1", *names}))
    if certificate.exists() and key.exists():
        known = x509.load_pem_x509_certificate(certificate.read_bytes())
        if _names(known) == wanted and _days_left(known) > RENEW_DAYS:
            return Certificate(certificate, key, _fingerprint(known.public_bytes(Encoding.DER)))
    made, secret = _make(wanted)
    _write_secret(key, secret)
    write_bytes(certificate, made.public_bytes(Encoding.PEM))
    return Certificate(certificate, key, _fingerprint(made.public_bytes(Encoding.DER)))


def _write_secret(path: Path, content: bytes) -> None:
    path.unlink(missing_ok=True)
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(content)


def _fingerprint(der: bytes) -> str:
    import hashlib

    digest = hashlib.sha256(der).hexdigest().upper()
    return ":".join(digest[i : i + 2] for i in range(0, len(digest), 2))


def _names(certificate: x509.Certificate) -> tuple[str, ...]:
    from cryptography import x509

    kind = x509.SubjectAlternativeName
    listed = certificate.extensions.get_extension_for_class(kind).value
    found = [str(each.value) for each in listed]
    return tuple(sorted(found))


def _days_left(certificate: x509.Certificate) -> float:
    left = certificate.not_valid_after_utc - datetime.datetime.now(datetime.UTC)
    return left.total_seconds() / 86_400


def _make(names: tuple[str, ...]) -> tuple[x509.Certificate, bytes]:
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "PALMS")])
    now = datetime.datetime.now(datetime.UTC) - datetime.timedelta(hours=1)
    alternatives = [_general_name(name) for name in names]
    made = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now)
        .not_valid_after(now + datetime.timedelta(days=VALID_DAYS))
        .add_extension(x509.SubjectAlternativeName(alternatives), critical=False)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    secret = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )  # fmt: skip
    return made, secret


def _general_name(name: str) -> x509.GeneralName:
    from cryptography import x509

    try:
        return x509.IPAddress(ipaddress.ip_address(name))
    except ValueError:
        return x509.DNSName(name)


def own_names(host: str) -> tuple[str, ...]:
    """Return the names and addresses by which others may call this machine."""
    name = socket.gethostname().lower()
    found = {name, f"{name.partition('.')[0]}.local"}
    if host in ("0.0.0.0", "::", ""):
        found |= _addresses()
    else:
        found.add(host.lower())
    return tuple(sorted(found))


def _addresses() -> set[str]:
    """Addresses of this machine; asking for a route sends nothing."""
    found = set()
    for family, far in ((socket.AF_INET, "192.0.2.1"), (socket.AF_INET6, "2001:db8::1")):
        try:
            with socket.socket(family, socket.SOCK_DGRAM) as probe:
                probe.connect((far, 9))
                found.add(str(probe.getsockname()[0]))
        except OSError:
            continue
    return found
