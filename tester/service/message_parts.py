"""Parts of messages to the service: texts with their limits, and a base that refuses unknown keys."""

from __future__ import annotations

from functools import partial
from typing import Annotated, ClassVar

from pydantic import AfterValidator, ConfigDict, Field

from tester.base.words import plain_text

_PLAIN = AfterValidator(partial(plain_text, where=""))
Name = Annotated[str, Field(max_length=200), _PLAIN]
PathText = Annotated[str, Field(max_length=4096), _PLAIN]
Note = Annotated[str, Field(max_length=2000), _PLAIN]
Reply = Annotated[str, Field(max_length=40), _PLAIN]
RecipeText = Annotated[str, Field(max_length=262_144)]
Speed = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]


class StrictMessage:
    """A message in which an unknown key is refused: a misspelt option must not be ignored."""

    __slots__ = ()
    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")
