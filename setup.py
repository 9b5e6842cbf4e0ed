"""What setuptools cannot read from pyproject.toml: where the packages lie, and the README with links for PyPI.

`remqa_data.generators` is the folder `generators`, and so on. In a clone they are symbolic links inside `remqa_data/`,
for checkers and editors. A build follows this mapping, so it needs no links: Windows and some zip tools leave none.
"""

import re
import tomllib
from pathlib import Path

from setuptools import find_packages, setup

ROOT = Path(__file__).parent
FOLDERS = ("agents", "configs", "evaluation", "generators", "templates")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def packages() -> list[str]:
    """All packages by the names under which they are imported; none is reached through a link."""
    linked = [f"remqa_data.{pattern}" for name in FOLDERS for pattern in (name, f"{name}.*")]
    own = find_packages(ROOT, include=["remqa_data", "remqa_data.*"], exclude=linked)
    others = find_packages(ROOT, include=[pattern for name in FOLDERS for pattern in (name, f"{name}.*")])
    return [*own, *(f"remqa_data.{package}" for package in others)]


def readable_anywhere(text: str) -> str:
    """Markdown whose relative links lead into the repository that [project.urls] names.

    As long as it names none, the words of such links stay and pictures go, so that no link is dead.
    """
    repository = PROJECT["urls"].get("Repository")

    def absolute(link: re.Match[str]) -> str:
        mark, words, target = link.groups()
        if "://" in target:
            return link[0]
        if repository is None:
            return "" if mark else words
        return f"{mark}[{words}]({repository}/{'raw' if mark else 'blob'}/v{PROJECT['version']}/{target})"

    return re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", absolute, text)


setup(
    packages=packages(),
    package_dir={f"remqa_data.{name}": name for name in FOLDERS},
    long_description=readable_anywhere((ROOT / "README.md").read_text(encoding="utf-8")),
    long_description_content_type="text/markdown",
)
