"""Writing a submission for `remqa-eval` while an agent acts; docs/SUBMISSIONS.md describes the file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium

from remqa_data.env import RemqaEnv
from remqa_data.env.episodes import Task
from remqa_data.errors import ActionError, one_line
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.limits import MAX_ACTIONS, MAX_NAME


class Recorder(gymnasium.Wrapper[dict[str, Any], Any, dict[str, Any], Any]):
    """Records each episode that ends, and writes all of them when it is closed.

    Parameters
    ----------
    env : Env
        A `RemqaEnv` over a dataset, wrapped or not.
    path : path
        The file to write, .jsonl; its folder is made at once.
    agent : str
        Name of the agent, for reports.

    Raises
    ------
    ActionError
        If the environment plays bare scenes, the agent is privileged, no submission is called so or by such an agent, or
        nothing can be written there.

    Notes
    -----
    A question that is played again replaces what was recorded of it. A submission holds whole steps (`MoveAhead`, not
    `MoveAhead 0.1`), and at most 500 before the manipulation; another step is an `ActionError` once it is done.
    """

    def __init__(self, env: gymnasium.Env[dict[str, Any], Any], path: str | Path, agent: str = "unnamed") -> None:
        super().__init__(env)
        remqa = env.unwrapped
        if not isinstance(remqa, RemqaEnv) or remqa.split is None:
            raise ActionError("only episodes of a dataset can be submitted: make the environment with root=...")
        if remqa.privileged:
            raise ActionError("a privileged agent cannot submit: make the environment without privileged=True")
        self._remqa = remqa
        if not isinstance(path, str | os.PathLike):
            raise ActionError(f"path is {path!r:.80}: give the file to write, something.jsonl")
        self.path = Path(path)
        if self.path.suffix != ".jsonl":
            raise ActionError(f"{path}: the file of a submission is called something.jsonl")
        if not isinstance(agent, str) or not 0 < len(agent) <= MAX_NAME:
            raise ActionError(f"the agent's name is {agent!r:.80}: give a text of 1 to {MAX_NAME} characters")
        try:
            self._header = Header(track="remqa", split=remqa.split, agent=agent)
        except ValueError as error:
            raise ActionError(f"the agent's name is {agent!r:.80}: {one_line(error)}") from None
        self.rows: dict[str, dict[str, Any]] = {}
        with _told_in_one_line(self.path):
            self._last = self._stored()
            if self.path.is_symlink() or (self._last is not None and not self.path.is_file()):
                raise ActionError(f"{path} is no regular file: give the path of one, something.jsonl")
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=self.path.parent):
                pass  # so files can be made there

    def step(self, action: Any) -> tuple[dict[str, Any], Any, bool, bool, dict[str, Any]]:
        """Do one action; the end of an episode makes it a row.

        Raises
        ------
        ActionError
            If no submission holds the episode any more; also as of `RemqaEnv.step`.
        """
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._check_walk()
        if terminated or truncated:
            row = self._row(info.get("answer"))
            self.rows[row["question_id"]] = row
        return observation, reward, terminated, truncated, info

    def save(self) -> None:
        """Write what was recorded so far; a file of before is replaced once there is something.

        Raises
        ------
        ActionError
            If something else, such as another recorder, has written the file meanwhile, or it cannot be written.
        """
        if not self.rows and self._last is not None:
            return
        with _told_in_one_line(self.path):
            if self._stored() != self._last:
                raise ActionError(
                    f"{self.path} was written by something else meanwhile: give each recorder a file of its own"
                )
            write_submission(self.path, self._header, list(self.rows.values()))
            self._last = self._stored()

    def close(self) -> None:
        """Write the submission and close the environment."""
        try:
            self.save()
        finally:
            super().close()

    def _stored(self) -> tuple[int, int] | None:
        """What tells the file apart from others of its name; None if there is none."""
        try:
            found = self.path.stat()
        except FileNotFoundError:
            return None
        return found.st_ino, found.st_mtime_ns

    @property
    def _task(self) -> Task:
        task = self._remqa.episode.task
        assert task is not None, "episodes of a dataset have a question"
        return task

    def _check_walk(self) -> None:
        """Refuse a walk that no submission holds."""
        walk = self._remqa.record.walk
        if len(walk) > MAX_ACTIONS:
            raise ActionError(
                f"{self._task.question_id}: a submission holds at most {MAX_ACTIONS} steps, not {len(walk)}"
            )
        for action in walk:
            if action.numbers:
                raise ActionError(f"{self._task.question_id}: a submission holds whole steps, not {str(action)!r}")

    def _row(self, answer: str | None) -> dict[str, Any]:
        record, task = self._remqa.record, self._task
        return {
            "question_id": task.question_id,
            "actions": [str(action) for action in record.walk],
            "box": None if record.box is None else list(record.box),
            "manipulation": None if record.manipulation is None else str(record.manipulation),
            "answer": answer,
        }


@contextmanager
def _told_in_one_line(path: Path) -> Iterator[None]:
    """What the system says of a file that it does not write, as an ActionError."""
    try:
        yield
    except (OSError, ValueError) as error:  # ValueError: no file is called so
        reason = error.strerror if isinstance(error, OSError) and error.strerror else one_line(error)
        raise ActionError(f"{one_line(path)} cannot be written: {reason}; give another path") from None
