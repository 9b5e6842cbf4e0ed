import ast
import subprocess
import sys
from pathlib import Path

import pytest

from remqa_data.errors import OpenCVError

ROOT = Path(__file__).parents[1]
FIX = "pip uninstall --yes opencv-python && pip install --force-reinstall --no-deps opencv-python-headless"


@pytest.mark.slow
def test_an_opencv_without_its_libraries_is_one_line_with_the_fix(tmp_path, monkeypatch) -> None:
    broken = "raise ImportError('libGL.so.1: cannot open shared object file:\\n No such file or directory')"
    (tmp_path / "cv2.py").write_text(broken)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{ROOT}")
    code = "from remqa_data.cli import main; main()"
    command = [sys.executable, "-c", code, "preview", "FloorPlan1", "-o", str(tmp_path / "preview.png")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "libGL.so.1: cannot open shared object file: No such file" in line
    assert line.endswith(FIX)
    assert not (tmp_path / "preview.png").exists()


def test_the_error_is_an_import_error_too() -> None:
    assert issubclass(OpenCVError, ImportError)


def test_opencv_is_imported_in_one_place() -> None:
    folders = [ROOT / folder for folder in ("remqa_data", "generators", "evaluation", "agents")]
    texts = {path: path.read_text(encoding="utf-8") for folder in folders for path in folder.rglob("*.py")}
    importing = {
        path.relative_to(ROOT).as_posix()
        for path, text in texts.items()
        if "cv2" in text  # to parse all takes seconds
        for node in ast.walk(ast.parse(text))
        if (isinstance(node, ast.Import) and any(alias.name.partition(".")[0] == "cv2" for alias in node.names))
        or (isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "cv2")
    }
    assert importing == {"remqa_data/opencv.py"}
