"""YAML files: those of `templates/`, which come with the package, and configurations; both are read without trust.

What is wrong with one is told in one line with the file and the key.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Collection, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, TypeVar

import yaml
from pydantic import AfterValidator, BaseModel, ValidationError

from remqa_data.errors import ConfigError, UnknownNameError, nearest_names, one_line

MOST_CONFIG_BYTES = 1 << 18
MOST_CONFIG_DEPTH = 8
"""Lists and mappings inside of one another; it takes four."""

M = TypeVar("M", bound=BaseModel)
T = TypeVar("T")


def template_text(name: str) -> str:
    """The text of a file of `templates/`.

    >>> template_text("traits.yaml").splitlines()[0]
    '# What the code knows of an object type by its name. Each type in objects.yaml lists the traits that it has.'
    """
    return (resources.files("remqa_data.templates") / name).read_text(encoding="utf-8")


def template_values(name: str) -> Mapping[str, Any]:
    """What a YAML file of `templates/` says.

    Raises
    ------
    ConfigError
        If it is no YAML, or says something twice.
    """
    return read_keys(template_text(name), name)


def template_rules(model: type[M], name: str) -> M:
    """The rules that a YAML file of `templates/` says, checked.

    Raises
    ------
    ConfigError
        If a key is missing, unknown or has a wrong value: names file, key and reason.
    """
    return parsed(model, template_text(name), name)


def entry_for_each(names: Collection[str]) -> AfterValidator:
    """Checks that a table of rules has an entry for each of some names."""

    def check(table: Mapping[str, T]) -> Mapping[str, T]:
        if missing := [name for name in names if name not in table]:
            raise ValueError(f"there is no entry for {missing[0]!r}")
        return table

    return AfterValidator(check)


def checked_pattern(pattern: str, needed: Collection[str], others: Collection[str] = ()) -> str:
    """A pattern as it is, which has some placeholders, perhaps some others, and none besides.

    >>> checked_pattern("the {noun}", ["noun"])
    'the {noun}'

    Raises
    ------
    ValueError
        If it has not: names them.
    """
    known = {name: f"{{{name}}}" for name in (*needed, *others)}
    try:
        is_plain = pattern.format(**known) == pattern
    except (KeyError, IndexError, ValueError, AttributeError, TypeError):
        is_plain = False
    if not is_plain or any(known[name] not in pattern for name in needed):
        also = f"; of these it needs {', '.join(known[name] for name in needed)}" if others else ""
        raise ValueError(f"expected the placeholders {', '.join(known.values())}, found {pattern!r:.200}{also}")
    return pattern


def _checked_word(word: str) -> str:
    if not re.fullmatch(r"\w+([ '-]\w+)*", word):
        raise ValueError(f"expected words of letters, with single blanks between them, found {word!r:.200}")
    return word


Word = Annotated[str, AfterValidator(_checked_word)]
"""One or several words of a phrase."""


def check_told_apart(words: Collection[str], things: str, key: str = "") -> None:
    """Check that no two things of a phrase are called alike, by words that a key has.

    >>> check_told_apart(["in", "on"], "relations")

    Raises
    ------
    ValueError
        Naming the first word, in the order of the alphabet, that is there twice.
    """
    counts = Counter(words)
    if twice := sorted(word for word in counts if counts[word] > 1):
        raise ValueError(f"{key}{': ' * bool(key)}{twice[0]!r} is said for two {things}; phrases are to be told apart")


def preset_names(package: str) -> tuple[str, ...]:
    """Names of the YAML files in a package of presets, such as "tiny" in `remqa_data.configs`; sorted."""
    files = (Path(entry.name) for entry in resources.files(package).iterdir())
    return tuple(sorted(file.stem for file in files if file.suffix == ".yaml"))


def read_config(kind: type[M], path: str | os.PathLike[str], package: str) -> M:
    """The configuration of a kind that a file says, or a preset of a package; a file of its name comes first.

    Raises
    ------
    ConfigError
        If the file cannot be read, or a key is missing, unknown or has a wrong value: names file, key and reason.
    """
    return parsed(kind, config_text(path, package), os.fspath(path))


def parsed(kind: type[M], text: str, where: str) -> M:
    """The configuration of a kind that a YAML text says.

    Raises
    ------
    ConfigError
        If it is no YAML, or a key is missing, unknown or has a wrong value: names where, the key and the reason.
    """
    return checked(kind, read_keys(text, where), where)


def config_text(path: str | os.PathLike[str], package: str) -> str:
    """The text of a configuration: a YAML file, or a preset of a package by its name; a file of that name comes first.

    Raises
    ------
    ConfigError
        If there is none; names the presets.
    """
    name, presets = os.fspath(path), preset_names(package)
    if name in presets and not Path(path).is_file():
        return (resources.files(package) / f"{name}.yaml").read_text(encoding="utf-8")
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        near = nearest_names(name, presets, count=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        msg = f"{name}: {reason}; give a YAML file, or one of the presets {', '.join(presets)}{hint}"
        raise ConfigError(msg) from None


def read_keys(text: str, where: str) -> Mapping[str, Any]:
    """The keys and values of a YAML text.

    Raises
    ------
    ConfigError
        If it is no YAML, no mapping, or holds what a configuration never needs.
    """
    if len(text) > MOST_CONFIG_BYTES:
        raise ConfigError(f"{where}: {len(text):,} characters; a configuration has at most {MOST_CONFIG_BYTES:,}")
    try:
        data: Any = yaml.load(text, _Plain)
    except _NotPlainError as error:
        raise ConfigError(f"{where}: {error}") from None
    except yaml.constructor.ConstructorError as error:
        what = "tags (!) are not read" if "for the tag" in str(error.problem) else error.problem
        raise ConfigError(f"{where}: {_at(error)}{what}") from None
    except yaml.composer.ComposerError as error:
        raise ConfigError(f"{where}: {_at(error)}a second document, where one is read") from None
    except yaml.MarkedYAMLError as error:
        raise ConfigError(f"{where}: not YAML: {_at(error)}{one_line(error.problem)[:200]}") from None
    except (yaml.YAMLError, ValueError) as error:  # ValueError: a date such as 2020-99-99, a number of 5,000 digits
        raise ConfigError(f"{where}: not YAML: {one_line(error)[:300]}") from None
    if data is None:
        raise ConfigError(f"{where}: says nothing; expected keys such as 'seed'")
    if not isinstance(data, Mapping):
        raise ConfigError(f"{where}: expected keys such as 'seed', found {type(data).__name__}")
    return data


def checked(kind: type[M], data: Mapping[str, Any], where: str) -> M:
    """The configuration of a kind that keys and values say.

    Raises
    ------
    ConfigError
        If a key is missing, unknown or has a wrong value: names where, the key and the reason.
    """
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        raise ConfigError(f"{where}: {_first_problem(error, kind)}") from None
    except UnknownNameError as error:  # of a validator: no ValueError, so pydantic lets it pass
        raise ConfigError(f"{where}: {error}") from None


def _at(error: yaml.MarkedYAMLError) -> str:
    """Where something is wrong, as the beginning of what is."""
    mark = error.problem_mark
    return "" if mark is None else f"line {mark.line + 1}, column {mark.column + 1}: "


class _NotPlainError(Exception):
    """What a configuration must not have; says where."""


class _Plain(yaml.SafeLoader):
    """YAML without what a configuration never needs, and what a few bytes of can ask for any amount of time.

    Its mappings say nothing twice: the last one would win, and nobody would know.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """The next node, with all that is in it."""
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        where = f"line {event.start_mark.line + 1}: "
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            raise _NotPlainError(f"{where}anchors and aliases (& and *) are not read")
        is_collection = isinstance(event, yaml.CollectionStartEvent)
        self._depth += is_collection
        if self._depth > MOST_CONFIG_DEPTH:
            raise _NotPlainError(f"{where}nested too deep")
        node = super().compose_node(parent, index)
        self._depth -= is_collection
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """A mapping."""
        found = super().construct_mapping(node, deep)
        seen = set()
        for key, _ in node.value:
            said = str(key.value)
            if key.tag.endswith(":bool"):
                raise _NotPlainError(
                    f'line {key.start_mark.line + 1}: YAML reads {said} as true or false; write "{said}"'
                )
            if said in seen:
                raise _NotPlainError(f"line {key.start_mark.line + 1}: the key {said!r:.80} is there twice")
            seen.add(said)
        return found


def _first_problem(error: ValidationError, kind: type[BaseModel]) -> str:
    """What is wrong with a configuration, in one line that begins with its key: what it does not know comes first.

    A key that is misspelt is missing, too, and to hear that of one that is there helps nobody.
    """
    problems = error.errors()
    unknown = next((problem for problem in problems if problem["type"] == "extra_forbidden"), None)
    problem = unknown or problems[0]
    # Of a value that may be of two types, pydantic tells the branch after the key; the key is enough.
    key = ".".join(
        str(part)
        for part in problem["loc"]
        if part not in ("constrained-int", "int", "[key]") and "tuple" not in str(part)
    )
    reason = _unknown_key(kind, problem["loc"]) if unknown else problem["msg"].removeprefix("Value error, ")
    if problem["type"] == "too_short":
        reason = f"expected at least {problem['ctx']['min_length']}, found {problem['ctx']['actual_length']}"
    return f"{one_line(key)[:80]}: {one_line(reason)}" if key else one_line(reason)


def _unknown_key(kind: type[BaseModel], place: tuple[int | str, ...]) -> str:
    """What there is to say of a key that a configuration does not have."""
    near = nearest_names(str(place[-1])[:80], _keys(kind, place[:-1]), count=1)
    return "there is no such key" + (f"; did you mean {near[0]!r}?" if near else "")


def _keys(kind: type[BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """The keys that a configuration has at a place; none where there may be one thing or another."""
    for part in place:
        inner = kind.model_fields[str(part)].annotation if part in kind.model_fields else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return []
        kind = inner
    return [field.alias or name for name, field in kind.model_fields.items()]
