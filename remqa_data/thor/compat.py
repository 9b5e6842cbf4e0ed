"""Importing this module puts our Controller in the place of AI2-THOR's, for code that cannot be edited.

>>> import ai2thor.controller
>>> import remqa_data.thor.compat
>>> from ai2thor.controller import Controller
>>> Controller.__module__
'remqa_data.thor.controller'
>>> issubclass(ai2thor.controller.BFSController, Controller)
True

Whoever has imported AI2-THOR's class by its name before keeps that: import this first, as in
`python -c "import remqa_data.thor.compat, runpy; runpy.run_path('theirs.py', run_name='__main__')"`.
"""

from __future__ import annotations

import ai2thor.controller

from remqa_data.thor import Controller

_OF_EVERY_CLASS = ("__dict__", "__weakref__")

ai2thor.controller.Controller = Controller
ai2thor.controller.BFSController = type(
    "BFSController",
    (Controller,),
    {name: value for name, value in vars(ai2thor.controller.BFSController).items() if name not in _OF_EVERY_CLASS},
)
