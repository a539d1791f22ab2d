"""The README is true: its shell commands and its Python run as printed."""

import re
import shutil
import sys
from pathlib import Path

import matplotlib as mpl
import pytest

from lenstrace.__main__ import main

ROOT = Path(__file__).parent.parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    """The fenced blocks of a language."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that looks like the checkout to someone who only reads designs/."""
    shutil.copytree(ROOT / "designs", tmp_path / "designs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_set_up_is_two_lines() -> None:
    set_up, tests = (block.strip() for block in blocks("sh")[:2])
    assert set_up == "pip install -e . && lenstrace report designs/double_gauss.toml"
    assert tests == 'pip install -e ".[test]" && python -m pytest'


def test_shell_commands_run(elsewhere: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = [line for block in blocks("sh")[2:] for line in block.splitlines() if line.startswith("lenstrace ")]
    assert len(lines) >= 4
    for line in lines:
        assert main(line.split()[1:]) == 0, line
        assert capsys.readouterr().out
    written = {word for line in lines for word in line.split() if word.endswith((".png", ".pdf"))}
    there = {path.name for path in elsewhere.iterdir() if path.is_file()}
    assert there >= written >= {"tessar.png", "double_gauss.pdf"}


@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_python_runs(number: int, elsewhere: Path) -> None:  # noqa: ARG001
    mpl.use("agg")
    exec(compile(blocks("python")[number], f"README block {number}", "exec"), {"__name__": "readme"})
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


def test_the_file_format_example_is_read() -> None:
    import lenstrace

    lens = lenstrace.loads(
        next(block for block in blocks("toml") if "surfaces = [\n" in block).replace("[aperture]  ", "[aperture]")
    )
    assert len(lens) == 9
