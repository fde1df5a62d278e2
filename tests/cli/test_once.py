"""What a command makes of its input is made once."""

from palms import advice, raster
from palms.localizer import live


def test_cells_and_advice_of_a_track(palms, world, monkeypatch):
    made = []

    def counted(module, name):
        original = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *a: made.append(name) or original(*a))

    for module in (raster, live):
        counted(module, "rasterize")
    counted(advice, "advise")
    result = palms("track", world.plan, world.scan, world.walk, "--trials", 2, "--json", "-")
    assert result.exit_code == 0, result.output
    assert sorted(made) == ["advise", "rasterize"]
