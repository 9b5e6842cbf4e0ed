"""Optional dependencies: imported when they are used, with an error that names the extra to install."""

from __future__ import annotations

import importlib
from types import ModuleType

from remqa_data.errors import MissingExtraError


def require(package: str, extra: str, instead: str = "") -> ModuleType:
    """Import an optional package, or say which extra brings it.

    Parameters
    ----------
    package : str
        Import name, such as "torch", or "torch.utils.data" for a module inside it.
    extra : str
        The extra of `remqa-data` that installs it, such as "torch".
    instead : str, optional
        What else can be done, such as "or leave the report out with --no-report".

    Raises
    ------
    MissingExtraError
        If the package is not installed. An error inside an installed package is passed on as it is.

    Examples
    --------
    >>> require("json", "report").dumps([1])
    '[1]'
    """
    top = package.partition(".")[0]
    try:
        importlib.import_module(top)
    except ModuleNotFoundError as error:
        if error.name != top:
            raise
        raise MissingExtraError(top, extra, instead) from error
    return importlib.import_module(package)
