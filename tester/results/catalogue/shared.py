"""The catalogue that a laboratory shares: any database that SQLAlchemy reaches, tested with PostgreSQL.

Needs the extra ``catalogue``. A command that lists runs brings the shared catalogue up to date with the runs of its
folder; runs of other folders stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, fields
from typing import Any

from tester.base.plugins import needs
from tester.results.catalogue.entries import CatalogueError, ConditionEntry, RunEntry, WantedRuns

try:
    import sqlalchemy as sa
    from sqlalchemy.exc import SQLAlchemyError
except ImportError as error:
    raise CatalogueError(needs("a shared catalogue", "SQLAlchemy", "catalogue")) from error

_TYPES: dict[str, sa.types.TypeEngine[Any]] = {
    "str": sa.Text(),
    "bool": sa.Boolean(),
    "int": sa.BigInteger(),
    "float": sa.Double(),
}

_METADATA = sa.MetaData()


def _columns(entry: type[RunEntry] | type[ConditionEntry], key: tuple[str, ...]) -> list[sa.Column[Any]]:
    """Return a column for each field of an entry; one that may be None may be NULL."""
    columns: list[sa.Column[Any]] = []
    for field in fields(entry):
        kind, _, optional = str(field.type).partition(" | ")
        columns.append(sa.Column(field.name, _TYPES[kind], primary_key=field.name in key, nullable=bool(optional)))
    return columns


RUN = sa.Table("friction_run", _METADATA, *_columns(RunEntry, ("origin", "name")))
CONDITION = sa.Table(
    "friction_condition",
    _METADATA,
    sa.Column("origin", sa.Text, primary_key=True),
    sa.Column("name", sa.Text, primary_key=True),
    *_columns(ConditionEntry, ("condition",)),
)


class SharedCatalogue:
    """A catalogue behind a database URL."""

    def __init__(self, url: str) -> None:
        """Connect, and make missing tables; raises CatalogueError."""
        try:
            self._engine = sa.create_engine(_with_driver(url))
            with self._engine.begin() as connection:
                _make_tables(connection)
        except ImportError as error:  # the database's driver
            raise CatalogueError(f"{needs('this shared catalogue', 'a driver', 'catalogue')} ({error})") from error
        except SQLAlchemyError as error:
            raise CatalogueError(f"the shared catalogue cannot be used: {error}") from error

    def fingerprints(self, origin: str) -> dict[str, str]:
        wanted = sa.select(RUN.c.name, RUN.c.fingerprint).where(RUN.c.origin == origin)
        with self._engine.connect() as connection:
            return {str(name): str(fingerprint) for name, fingerprint in connection.execute(wanted)}

    def put(self, run: RunEntry, conditions: Iterable[ConditionEntry]) -> None:
        """Store a run, in place of any earlier entry; raises CatalogueError."""
        key = {"origin": run.origin, "name": run.name}
        rows = [key | asdict(condition) for condition in conditions]
        try:
            with self._engine.begin() as connection:
                self._delete(connection, run.origin, run.name)
                connection.execute(RUN.insert(), asdict(run))
                if rows:
                    connection.execute(CONDITION.insert(), rows)
        except SQLAlchemyError as error:
            raise CatalogueError(f"the shared catalogue cannot be written: {error}") from error

    def remove(self, origin: str, name: str) -> None:
        with self._engine.begin() as connection:
            self._delete(connection, origin, name)

    def runs(self, wanted: WantedRuns) -> list[RunEntry]:
        query = sa.select(RUN).order_by(RUN.c.started_utc, RUN.c.name)
        if wanted.compound:
            framed = sa.literal("\n") + RUN.c.compounds + sa.literal("\n")
            query = query.where(framed.contains(f"\n{wanted.compound}\n", autoescape=True))
        if wanted.since:
            query = query.where(RUN.c.started_utc >= wanted.since)
        if wanted.until:
            query = query.where(RUN.c.started_utc <= wanted.until)
        if wanted.recipe:
            query = query.where(sa.func.lower(RUN.c.recipe).contains(wanted.recipe.lower(), autoescape=True))
        with self._engine.connect() as connection:
            return [RunEntry(**row) for row in connection.execute(query).mappings()]

    def conditions(self, run: RunEntry) -> list[ConditionEntry]:
        names = [field.name for field in fields(ConditionEntry)]
        query = (
            sa.select(*(CONDITION.c[name] for name in names))
            .where(CONDITION.c.origin == run.origin, CONDITION.c.name == run.name)
            .order_by(CONDITION.c.condition)
        )
        with self._engine.connect() as connection:
            return [ConditionEntry(**row) for row in connection.execute(query).mappings()]

    def close(self) -> None:
        self._engine.dispose()

    @staticmethod
    def _delete(connection: sa.Connection, origin: str, name: str) -> None:
        for table in (RUN, CONDITION):
            connection.execute(table.delete().where(table.c.origin == origin, table.c.name == name))


def _make_tables(connection: sa.Connection) -> None:
    """Make missing tables; raises CatalogueError for tables of another version."""
    _METADATA.create_all(connection)
    present = sa.inspect(connection)
    for table in (RUN, CONDITION):
        columns = {column["name"] for column in present.get_columns(table.name)}
        if columns != set(table.c.keys()):
            raise CatalogueError(
                f"the shared catalogue was made by another version of friction-tester: its table {table.name} has "
                f"other columns ({', '.join(sorted(columns ^ set(table.c.keys())))}). Drop the tables {RUN.name} and "
                f"{CONDITION.name}: they are made again from the runs"
            )


def _with_driver(url: str) -> str:
    """Return a PostgreSQL URL with the driver that the extra installs, any other unchanged."""
    scheme, rest = url.split("://", 1) if "://" in url else ("", url)
    return f"postgresql+psycopg://{rest}" if scheme in ("postgresql", "postgres") else url
