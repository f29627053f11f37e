"""A material's file in its folder: its text with its hash, the files it refers to, and its problems."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path, PurePosixPath
from typing import Generic, Literal, NoReturn, TypeVar

from pydantic import ValidationError

from tester.base.source import InvalidSource, Problem, read_tree
from tester.base.trouble import in_words
from tester.base.validation import problems_of
from tester.inputs.materials.material_schema import MaterialModel

ModelT = TypeVar("ModelT", bound=MaterialModel)
Role = Literal["compound", "surface"]
FOLDERS: dict[Role, str] = {"compound": "compounds", "surface": "surfaces"}
"""Folders of each role, beside a recipe and in the package."""


@dataclass(frozen=True, slots=True)
class DataFile:
    """A file that a material's file refers to: its name relative to that, and its bytes."""

    name: str
    content: bytes

    @property
    def sha256(self) -> str:
        """Return the hash of its bytes, hexadecimal."""
        return sha256(self.content).hexdigest()


@dataclass(frozen=True, slots=True)
class MaterialFile:
    """A material's file as read."""

    role: Role | Literal["law"]
    name: str
    """Name in recipes."""
    path: Path
    text: str
    data: tuple[DataFile, ...] = ()
    doubts: tuple[Problem, ...] = ()

    @property
    def sha256(self) -> str:
        """Return the hash of its text, UTF-8, hexadecimal."""
        return sha256(self.text.encode()).hexdigest()


class DataFileError(ValueError):
    """A file referred to by a material's file cannot be used; the message gives the reason."""


def read_beside(path: Path, name: str, at_most: int) -> DataFile:
    """Return a file beside a material's file, or in a folder below it. Raises DataFileError."""
    relative = PurePosixPath(name)
    if relative.is_absolute() or ".." in relative.parts or "\\" in name or ":" in name:
        raise DataFileError(f'"{name}" is not beside this file (expected a name such as dma.csv)')
    place = path.parent / relative
    try:
        if not place.is_file():
            raise DataFileError(f'there is no file "{name}" beside this one')
        if place.stat().st_size > at_most:
            raise DataFileError(f'"{name}" is larger than {at_most // 1024**2} MB')
        return DataFile(relative.as_posix(), place.read_bytes())
    except OSError as error:
        raise DataFileError(f'"{name}" cannot be read: {in_words(error)}') from error


def decoded(content: bytes) -> str:
    """Return the text of an instrument's file: UTF-8, UTF-16 with its mark, else Windows-1252."""
    for mark, coding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig")):
        if content.startswith(mark):
            return content.decode(coding, errors="replace")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


Place = Callable[[int], tuple[int, int]]
"""Returns line and column, from 1, of a row of a table, counted from 0."""


@dataclass(slots=True)
class Findings:
    """Problems, which make a file invalid; doubts, which commands print and a run records; notes on conversions."""

    file: str
    problems: list[Problem] = field(default_factory=list[Problem])
    doubts: list[Problem] = field(default_factory=list[Problem])
    notes: list[str] = field(default_factory=list[str])
    lasting: list[str] = field(default_factory=list[str])
    """Doubts that the imported file no longer shows: an import writes them down."""

    def refuse(self, place: tuple[int, int], message: str) -> None:
        """Add a problem."""
        self.problems.append(Problem(self.file, *place, message))

    def doubt(self, place: tuple[int, int], message: str, *, lasting: bool = False) -> None:
        """Add a doubt."""
        self.doubts.append(Problem(self.file, *place, message))
        if lasting:
            self.lasting.append(f"line {place[0]} of what was imported: {message}")

    def end(self) -> None:
        """Raise InvalidSource if there are problems."""
        if self.problems:
            raise InvalidSource(self.problems)

    def refuse_now(self, place: tuple[int, int], message: str) -> NoReturn:
        """Add a problem that ends the reading; raises InvalidSource."""
        self.refuse(place, message)
        raise InvalidSource(self.problems)

    def take(self, other: Findings) -> None:
        """Add the doubts and notes of a file that this one refers to."""
        self.doubts += other.doubts
        self.notes += other.notes


class OpenedMaterial(Generic[ModelT]):
    """A material's file while it is read: its tree, its problems, and its content if it is valid."""

    def __init__(self, source: Path | str, name: str | None, model: type[ModelT], expected: str) -> None:
        """Read and validate. ``expected``: the keys of such a file, in words. Raises InvalidSource if unreadable."""
        self.tree, problems = read_tree(source, name)
        self.findings = Findings(self.tree.name, list(problems))
        self.model: ModelT | None = None
        if not isinstance(self.tree.data, dict):
            self.findings.refuse((1, 1), expected)
            return
        try:
            self.model = model.model_validate(self.tree.data)
        except ValidationError as error:
            self.findings.problems += problems_of(error, self.tree, model)

    def content(self) -> ModelT:
        """Return the content; raises InvalidSource with every problem."""
        self.findings.end()
        assert self.model is not None
        return self.model

    def data_file(self, path: Path, key: tuple[str, ...], name: str, at_most: int) -> DataFile | None:
        """Return a file beside this one, which ``key`` names; None with a problem if it cannot be used."""
        try:
            return read_beside(path, name, at_most)
        except DataFileError as error:
            self.findings.refuse(self.tree.position(key), f"{key[-1]}: {error}")
            return None

    def kept(self, role: Role, path: Path, data: tuple[DataFile, ...]) -> MaterialFile:
        """Return the file as read, with its author's doubts and those of the reading. Raises InvalidSource."""
        model = self.content()
        for number, doubt in enumerate(model.doubts):
            self.findings.doubt(self.tree.position(("doubts", number)), doubt)
        return MaterialFile(role, model.name, path, self.tree.text, data, tuple(sorted(self.findings.doubts)))
