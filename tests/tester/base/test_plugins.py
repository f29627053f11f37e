"""Extensions come from installed packages, by name, on request, and only where allowed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import pytest

from tester.base.plugins import ALLOW_VARIABLE, PluginError, Plugins, allow_only, needs, plugins
from tester.cli.main import invoke
from tester.results.catalogue import open_catalogue
from tester.results.catalogue.entries import CatalogueError
from tester.run import provenance

MODULE = "LAW = 'a law'\n"


def install(folder: Path, package: str, entry_points: str, **files: str) -> None:
    """Lay a package of version 1.2 into a folder of sys.path, with an installer's metadata beside it."""
    (folder / package).mkdir(parents=True)
    for name, text in {"__init__.py": "", **files}.items():
        (folder / package / name).write_text(text, "utf-8")
    about = folder / f"{package}-1.2.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.2\n")
    (about / "top_level.txt").write_text(package)
    (about / "entry_points.txt").write_text(entry_points)


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Begin and end without anything loaded in this process."""
    monkeypatch.setenv(ALLOW_VARIABLE, "")  # so that it is restored
    monkeypatch.delenv(ALLOW_VARIABLE)
    plugins.cache_clear()
    yield
    plugins.cache_clear()


@pytest.fixture
def acme(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's package with one law and one profile; its modules are unloaded afterwards."""
    before = set(sys.modules)
    declared = "[friction_tester.laws]\nacme_law = acme.law:LAW\n[friction_tester.profiles]\nacme_cell = acme\n"
    install(tmp_path, "acme", declared, **{"law.py": MODULE, "acme_cell.toml": 'kind = "load_cell"\n'})
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    for name in set(sys.modules) - before:
        del sys.modules[name]


@pytest.mark.parametrize("name", ["acme_law", "acme.law:LAW"])
def test_an_extension_is_found_by_entry_point_and_by_dotted_name(acme: Path, name: str) -> None:
    assert Plugins().load("laws", name) == "a law"


def test_loaded_extensions_are_on_record(acme: Path) -> None:
    found = Plugins()
    found.load("laws", "acme_law")
    (loaded,) = found.loaded
    assert (loaded.name, loaded.target) == ("acme_law", "acme.law:LAW")
    assert (loaded.distribution, loaded.version) == ("acme", "1.2")
    assert loaded.sha256 == sha256((acme / "acme" / "law.py").read_bytes()).hexdigest()
    assert loaded.describe() == f"acme 1.2, acme.law:LAW, sha256 {loaded.sha256}"


def test_a_dotted_name_is_on_record_with_its_package(acme: Path) -> None:
    found = Plugins()
    found.load("laws", "acme.law:LAW")
    assert (found.loaded[0].distribution, found.loaded[0].version) == ("acme", "1.2")


def test_a_module_that_refuses_its_own_values_cannot_be_loaded(acme: Path) -> None:
    (acme / "wrong.py").write_text("raise ValueError('the unit \\'deg/min\\' is not in the table')\n")
    with pytest.raises(PluginError, match=r"wrong:LAW.* cannot be loaded: the unit 'deg/min'"):
        Plugins().load("laws", "wrong:LAW")


def test_a_module_of_no_package_is_on_record_as_such(acme: Path) -> None:
    (acme / "loose.py").write_text("LAW = 1\n")
    found = Plugins()
    found.load("laws", "loose:LAW")
    assert found.loaded[0].describe().startswith("of no installed package, loose:LAW, sha256 ")


@pytest.mark.parametrize("name", ["acme_cell", "acme:acme_cell"])
def test_a_profile_is_a_file_of_the_package_and_hashed_itself(acme: Path, name: str) -> None:
    found = Plugins()
    assert found.text("profiles", name, ".toml") == 'kind = "load_cell"\n'
    assert found.loaded[0].sha256 == sha256(b'kind = "load_cell"\n').hexdigest()


def test_listing_and_refusing_import_nothing(acme: Path) -> None:
    found = Plugins(allowed=())
    assert Plugins().names("laws") == ("acme_law",) and found.names("laws") == ()
    with pytest.raises(PluginError):
        found.load("laws", "acme_law")
    assert not {"acme", "acme.law"} & set(sys.modules)


@pytest.mark.parametrize("name", ["./law.py", "acme/law", "acme\\law", "law.py", "/tmp/law.py:LAW", "acme.law:x.py"])
def test_a_path_is_refused(acme: Path, name: str) -> None:
    with pytest.raises(PluginError, match="is a path"):
        Plugins().load("laws", name)


@pytest.mark.parametrize("name", ["", "a b", "acme law:LAW", "acme.law:", ":LAW", "os:system()", "..x:y"])
def test_invalid_names_are_refused(acme: Path, name: str) -> None:
    with pytest.raises(PluginError, match="is no name of an extension"):
        Plugins().load("laws", name)


@pytest.mark.parametrize("name", ["acme_law", "acme.law:LAW", "os:getcwd"])
def test_an_extension_not_allowed_at_start_is_refused_with_the_remedy(acme: Path, name: str) -> None:
    with pytest.raises(PluginError, match=r"not allowed here \(allowed: other\).*tester serve --allow ") as refused:
        Plugins(allowed=["other"]).load("laws", name)
    assert name in str(refused.value)


def test_an_extension_allowed_at_start_is_loaded(acme: Path) -> None:
    assert Plugins(allowed=["acme_law"]).load("laws", "acme_law") == "a law"


def test_an_unknown_name_is_refused_with_those_that_are_declared(acme: Path) -> None:
    with pytest.raises(PluginError, match=r'no extension "acme_lav".*friction_tester.laws \(declared: acme_law\)'):
        Plugins().load("laws", "acme_lav")


@pytest.mark.parametrize(
    ("name", "why"),
    [("acme.law:NONE", "no attribute 'NONE'"), ("acme.no:LAW", "No module named 'acme.no'"), ("nobody:LAW", "nobody")],
)
def test_a_failed_load_names_its_reason(acme: Path, name: str, why: str) -> None:
    with pytest.raises(PluginError, match=rf"\({name}\) cannot be loaded: .*{why}"):
        Plugins().load("laws", name)


def test_a_profile_missing_from_its_package_is_reported(acme: Path) -> None:
    with pytest.raises(PluginError, match=r"\(acme:none\) cannot be loaded: .*none\.toml"):
        Plugins().text("profiles", "acme:none", ".toml")


def test_a_name_that_two_packages_declare_is_refused_and_both_are_named(acme: Path) -> None:
    install(acme, "bolt", "[friction_tester.laws]\nacme_law = bolt:LAW\n")
    with pytest.raises(PluginError, match="acme and bolt both declare it"):
        Plugins().load("laws", "acme_law")


@pytest.mark.parametrize(("said", "allowed"), [(None, None), ("", set()), ("one, two:x", {"one", "two:x"})])
def test_the_environment_limits_what_this_process_may_load(
    said: str | None, allowed: set[str] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    if said is not None:
        monkeypatch.setenv(ALLOW_VARIABLE, said)
    assert plugins().allowed == allowed


def test_a_start_allows_names_beside_those_of_the_environment_and_passes_them_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert plugins().allowed is None
    allow_only(())
    assert plugins().allowed == frozenset()
    allow_only(["one"])
    allow_only(["two:x"])
    assert plugins().allowed == {"one", "two:x"} and os.environ[ALLOW_VARIABLE] == "one,two:x"


def test_help_does_not_look_for_extensions() -> None:
    code = "import sys; from tester.cli.main import invoke; invoke(['--help']); "
    code += "print('tester.base.plugins' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parents[3], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "False"


def test_the_command_that_installs_an_extra_is_named() -> None:
    text = needs("the format parquet", "pyarrow", "parquet")
    assert text.startswith('the format parquet needs pyarrow: pip install "friction-tester[parquet]"')


@pytest.mark.parametrize(
    ("command", "library", "extra"),
    [
        (["sweep", "quickstart", "--dask", "tcp://127.0.0.1:1", "--out", "sweeps"], "distributed", "cluster"),
    ],
)
def test_a_command_that_needs_an_extra_is_a_usage_error(
    command: list[str], library: str, extra: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, library, None)
    assert invoke(command) == 2
    assert f'pip install "friction-tester[{extra}]"' in capsys.readouterr().err


def test_a_shared_catalogue_names_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sqlalchemy", None)
    monkeypatch.delitem(sys.modules, "tester.results.catalogue.shared", raising=False)
    with pytest.raises(CatalogueError, match=r"SQLAlchemy: pip install .friction-tester\[catalogue\]"):
        open_catalogue(tmp_path, "sqlite://")


def test_a_shared_catalogue_without_its_driver_names_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("sqlalchemy", reason="the extra `catalogue` is not installed")
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(CatalogueError, match=r"a driver: pip install .friction-tester\[catalogue\]"):
        open_catalogue(tmp_path, "postgresql://nobody@127.0.0.1:1/none")


def test_a_record_names_the_missing_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provenance, "LIBRARIES", ("click", "no-such-distribution"))
    versions = provenance.library_versions()
    assert versions["no-such-distribution"] == "not installed" and versions["click"][0].isdigit()
