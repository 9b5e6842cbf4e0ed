"""The files of `templates/`, which come with the package."""

from __future__ import annotations

from importlib import resources
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel

Rules = TypeVar("Rules", bound=BaseModel)


def template_text(name: str) -> str:
    """The text of a file of `templates/`.

    >>> template_text("traits.yaml").splitlines()[0]
    '# What the code knows of an object type by its name. Each type in objects.yaml lists the traits that it has.'
    """
    return (resources.files("remqa_data.templates") / name).read_text(encoding="utf-8")


def template_values(name: str) -> Any:
    """What a YAML file of `templates/` says."""
    return yaml.safe_load(template_text(name))


def template_rules(model: type[Rules], name: str) -> Rules:
    """The rules that a YAML file of `templates/` says, checked.

    Raises
    ------
    pydantic.ValidationError
        If it says anything else.
    """
    return model.model_validate(template_values(name))
