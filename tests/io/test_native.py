"""The native file: what is written is read again to the last bit, and nothing is left half-written."""

import dataclasses

import jax
import pytest

import lenstrace
from lenstrace import Lens, PrescriptionError
from lenstrace.io.native import shortest_inverse


def test_what_is_written_is_read_again_to_the_last_bit(rich_lens: Lens, designs: dict[str, Lens]) -> None:
    for lens in (rich_lens, *designs.values()):
        again = lenstrace.loads(lenstrace.dumps(lens))
        # what is written is in mm, whatever the unit of the file that was read
        in_mm = dataclasses.replace(lens, fields=dataclasses.replace(lens.fields, length_unit="mm"))
        old, new = (jax.tree_util.tree_flatten(each) for each in (in_mm, again))
        assert [float(leaf) for leaf in old[0]] == [float(leaf) for leaf in new[0]]
        assert old[1] == new[1]


def test_shortest_inverse_gives_back_what_a_person_wrote() -> None:
    for radius in (56.20238, -435.76044, 0.1, 1e12, 3.0):
        assert shortest_inverse(1 / radius, lambda r: 1 / r, 1 / (1 / radius)) == radius


def test_saving_writes_the_whole_file_or_nothing(tmp_path, designs: dict[str, Lens]) -> None:
    path = tmp_path / "lens.toml"
    lenstrace.save(designs["tessar"], path)
    assert lenstrace.load(path)[2].radius == 22.5851
    with pytest.raises(PrescriptionError, match="cannot be written"):
        lenstrace.save(designs["tessar"], tmp_path / "no folder" / "lens.toml")
    assert [each.name for each in tmp_path.iterdir()] == ["lens.toml"]
    with pytest.raises(PrescriptionError, match=r"nothing.toml: cannot be read"):
        lenstrace.load(tmp_path / "nothing.toml")


def test_a_changed_medium_is_saved_as_it_is_traced(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    for medium in (lenstrace.glass("CDGM:F2"), lenstrace.optics.media.Constant(1.9)):
        changed = lens.replace(surface=1, medium=medium)
        again = lenstrace.loads(lenstrace.dumps(changed))
        assert again.system.index[1, 1] == changed.system.index[1, 1] == medium.index(0.55)
    assert "SF5 (SCHOTT)" in repr(lens.replace(surface=1, glass="SF5"))
