from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

__version__: str

def sweep(words: Sequence[str]) -> int: ...
def scenes() -> list[tuple[str, str]]: ...
def fit(
    sizes: Sequence[float],
    errors: Sequence[float],
    floors: Sequence[float],
    sigmas: Sequence[float | None],
    order: float | None,
    at_least: bool,
    exact: bool,
    tolerance: float | None,
    log: float,
    reference: float | None,
) -> dict[str, Any]: ...
def read(
    text: str,
    dimension: int | None,
    ratio: float | None,
    in_time: bool,
    by: Sequence[str],
    runs: bool,
    errors: Sequence[str],
) -> tuple[list[str], list[dict[str, Any]]]: ...
def settles(levels: int, decision: str, probability: float | None, before: str | None) -> bool: ...
def verify(
    scene: str,
    solve: Callable[[dict[str, Any]], Any],
    n: Sequence[int] | None,
    steps: Sequence[int] | None,
    pressure: bool,
    orders_only: bool,
    density: bool,
    out: PathLike[str] | str | None,
) -> str: ...
