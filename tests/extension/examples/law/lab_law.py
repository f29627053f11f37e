"""Friction that falls with the load, as of rubber on a smooth hard track: mu = 1.1 (load / 100 N)^(-1/9)."""

from collections.abc import Mapping


class Schallamach:
    """The coefficient of every compound: it does not depend on temperature or speed."""

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient at degC, N above 0, m/s."""
        return 1.1 * (load_n / 100.0) ** (-1.0 / 9.0)


def schallamach(compound: str, figures: Mapping[str, float]) -> Schallamach:
    """Return the law of a compound; it takes no figures."""
    return Schallamach()
