"""Tells setuptools where the packages lie; everything else about the package is in pyproject.toml.

`remqa_data.generators` is the folder `generators`, and so on. In a clone they are symbolic links inside `remqa_data/`,
for checkers and editors. A build follows this mapping, so it needs no links: Windows and some zip tools leave none.
"""

from setuptools import find_packages, setup

FOLDERS = ("agents", "evaluation", "generators", "templates")


def inside(folder: str) -> bool:
    """Whether a package belongs to the library's own folder and is not reached through a link."""
    return not any(folder == f"remqa_data.{name}" or folder.startswith(f"remqa_data.{name}.") for name in FOLDERS)


own = filter(inside, find_packages(include=["remqa_data", "remqa_data.*"]))
others = find_packages(include=[pattern for name in FOLDERS for pattern in (name, f"{name}.*")])
setup(
    packages=[*own, *(f"remqa_data.{package}" for package in others)],
    package_dir={f"remqa_data.{name}": name for name in FOLDERS},
)
