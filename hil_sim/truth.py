"""What every table of a plant file has in common: strictness and kinds of numbers."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["Interval", "NotNegative", "Part", "Positive", "Probability", "Truth", "Vector"]

Vector = Annotated[tuple[float, float, float], Field(strict=False)]
Interval = Annotated[tuple[float, float], Field(strict=False)]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Part = Annotated[float, Field(ge=0.0, le=1.0)]
Probability = Part


class Truth(BaseModel):
    """A table of the plant file: unknown keys, nan and inf are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
