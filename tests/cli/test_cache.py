"""The commands keep compiled programs in the user's cache folder."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
SLAB = str(ROOT / "designs" / "negative_index_slab.toml")


def spots(**environment: object) -> subprocess.CompletedProcess[str]:
    """The command, in a process whose environment says nothing else of a cache."""
    known = {name: value for name, value in os.environ.items() if not name.startswith(("JAX_", "XDG_"))}
    return subprocess.run(
        [sys.executable, "-m", "lenstrace", "spots", SLAB, "--rings", "2"],
        cwd=ROOT,
        env=known | {name: str(value) for name, value in environment.items()},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def programs(folder: Path) -> set[str]:
    """The compiled programs below a folder; a note of when each was last used may stand beside it."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file() and "atime" not in path.name}


def test_compiled_programs_are_kept_and_used_again(tmp_path: Path) -> None:
    first = spots(XDG_CACHE_HOME=tmp_path)
    assert (first.returncode, first.stderr) == (0, "")
    kept = programs(tmp_path)
    assert kept
    assert all(name.startswith("lenstrace/") for name in kept)
    second = spots(XDG_CACHE_HOME=tmp_path)
    assert (second.returncode, second.stderr, second.stdout) == (0, "", first.stdout)
    assert programs(tmp_path) == kept


def test_a_cache_folder_of_the_environment_is_used_instead(tmp_path: Path) -> None:
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    found = spots(
        XDG_CACHE_HOME=ours,
        JAX_COMPILATION_CACHE_DIR=theirs,
    )
    assert (found.returncode, found.stderr) == (0, "")
    assert programs(theirs)
    assert not ours.exists()


def test_a_cache_folder_that_cannot_be_written_stops_nothing(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("in the way")
    found = spots(XDG_CACHE_HOME=file)
    assert (found.returncode, found.stderr) == (0, "")
    assert "Negative-index slab" in found.stdout
    assert file.read_text() == "in the way"
