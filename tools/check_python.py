"""Says in one line what a machine lacks to install remqa-data with the Python that runs this, before pip is asked.

On a bare Debian a Python cannot make a virtual environment, and where PyBullet has no wheel pip tells after minutes, in
a wall of text, that there is no compiler or no Python.h. Needs nothing but the standard library.
"""

import importlib.util
import os
import platform
import shutil
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path

PYBULLET_WHEELS = ((3, 10), (3, 11))
"""Versions of CPython for which PyBullet 3.2.7 has a wheel, on Linux x86-64 with glibc only."""


def main() -> int:
    """Print what is missing and how to get it; 1 if anything is."""
    missing = missing_parts()
    if missing:
        print(
            f"{sys.executable} (Python {_version()}) lacks {' and '.join(missing)}.", _advice(missing), file=sys.stderr
        )
    return int(bool(missing))


def missing_parts() -> list[str]:
    """What is not there, of `venv`, `compiler` and `headers`; the last two only where PyBullet has to be compiled."""
    found = {"venv": importlib.util.find_spec("ensurepip") is not None}
    if not has_pybullet_wheel():
        compilers = (os.environ.get("CXX") or "c++", "g++", "clang++")
        found["compiler"] = any(shutil.which(name.split()[0]) for name in compilers)
        found["headers"] = (Path(sysconfig.get_path("include")) / "Python.h").is_file()
    return [part for part, is_there in found.items() if not is_there]


def has_pybullet_wheel() -> bool:
    """Whether PyPI has a wheel of PyBullet for this Python on this machine."""
    return (
        sys.platform == "linux"
        and platform.machine() == "x86_64"
        and platform.python_implementation() == "CPython"
        and platform.libc_ver()[0] == "glibc"
        and sys.version_info[:2] in PYBULLET_WHEELS
    )


def debian_packages(missing: Iterable[str]) -> list[str]:
    """The packages of Debian and Ubuntu that bring what is missing for their own Python."""
    names = {"venv": f"python{_version()}-venv", "compiler": "g++", "headers": f"python{_version()}-dev"}
    return [names[part] for part in missing]


def _advice(missing: list[str]) -> str:
    why = "" if missing == ["venv"] else "PyBullet has no wheel for it and is compiled (5 to 25 minutes). "
    if shutil.which("apt-get") and sys.base_prefix == "/usr":
        return f"{why}Run: apt-get install {' '.join(debian_packages(missing))}"
    if sys.platform == "darwin":
        return f"{why}Run: xcode-select --install"
    return f"{why}Install them, or name another Python: make PYTHON=/path/to/python3.11"


def _version() -> str:
    return f"{sys.version_info.major}.{sys.version_info.minor}"


if __name__ == "__main__":
    sys.exit(main())
