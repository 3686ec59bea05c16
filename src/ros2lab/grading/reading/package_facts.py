"""What package.xml, setup.py and setup.cfg say: the facts that the questions ask for, found by parsing.

Faults of a package are found by `diagnose`, so that a lost point and the advice for it have the same source.
A fact that only running setup.py could tell counts as true; the build shows whether it is.
"""

from __future__ import annotations

import html
import os
import re
from collections.abc import Collection, Iterable, Mapping

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.packaging.manifest_faults import manifest_faults
from ros2lab.diagnose.packaging.packaging_faults import packaging_faults
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.setup_script import SetupScript
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.reading.graded_package import Package, written_modules
from ros2lab.manifest_words import describes, is_to_be_done, names_its_reader

DECLARED = "has_"  # prefix of the fact that a package is declared that no module imports
# The facts of package.xml that a finding of `diagnose` makes false. `declares_<name>` for each package that
# the assignment needs, and whether description, license and maintainer are written, come from the file
# itself.
MANIFEST_FINDINGS: Mapping[str, frozenset[str]] = {
    "is_valid": frozenset(("manifest-invalid",)),
    "is_ament_python": frozenset(("build-type-missing", "build-type-unknown", "build-type-cmake")),
    "dependencies_exist": frozenset(("dependency-unknown", "dependency-not-ros")),
    "declares_all_imports": frozenset(("dependency-undeclared",)),
}
# The same for setup.py, setup.cfg and what they name. `name_agrees`, `marker_exists`, `manifest_is_installed`
# and `is_described` come from the files themselves.
SETUP_FINDINGS: Mapping[str, frozenset[str]] = {
    "is_valid": frozenset(("setup-syntax", "setup-missing", "setup-import", "name-undefined-in-setup")),
    "installs_modules": frozenset(("package-folder-missing", "package-not-listed", "init-file-missing")),
    "marker_is_installed": frozenset(("marker-not-installed",)),
    "data_files_exist": frozenset(("data-file-missing",)),
    "scripts_go_to_lib": frozenset(("setup-cfg-missing",)),
    "cfg_has_no_dashes": frozenset(("setup-cfg-dashes",)),
    "has_entry_points": frozenset(("entry-points-key", "entry-points-missing")),
    "entry_points_lead_to_functions": frozenset(
        (
            "entry-point-comma",
            "entry-point-spec",
            "entry-point-twice",
            "entry-point-module",
            "entry-point-no-function",
            "entry-point-function",
        )
    ),
}

# The text that a setup.py that cannot be read must contain for a fact about it to count as true.
_TRACES = {
    "installs_modules": "packages",
    "marker_is_installed": "resource_index/packages",
    "manifest_is_installed": "package.xml",
    "data_files_exist": "data_files",
    "has_entry_points": "console_scripts",
    "entry_points_lead_to_functions": "console_scripts",
    "name_agrees": "name",
    "is_described": "description",
}


def manifest_facts(package: Package, names: Collection[str], asked: Collection[str]) -> dict[str, bool]:
    """Return the facts of package.xml.

    Args:
        package: the submission's package.
        names: the names of all packages in the submission.
        asked: the packages that the assignment needs; those that are imported must be declared.
    """
    if not package.has("package.xml"):
        return {"is_there": False}
    text = re.sub(r"<!--.*?(?:-->|\Z)", "", read_text(package.folder / "package.xml"), flags=re.DOTALL)
    # This also reads a file that is not valid XML: its other lines may be right.
    tags = re.findall(r"<(\w+)\b[^<>]*>\s*([^<>]*)", text)
    manifest = package.manifest
    declared = {
        value.strip() for tag, value in tags if tag in ("depend", "exec_depend", "run_depend", "build_depend")
    }
    if manifest:
        declared = {dependency.name for dependency in (*manifest.build_depends, *manifest.exec_depends)}
    findings = [*manifest_faults(package, names)]
    imported = {
        imported_name.target.partition(".")[0]
        for source in package.own_sources
        for imported_name in source.imports
    }
    # Where none of them is imported, nothing was written yet.
    required = [name for name in asked if name in imported] or [*asked]
    missing = [name for name in required if name not in declared]
    facts = {"is_there": True}
    for fact, codes in MANIFEST_FINDINGS.items():
        facts[fact] = not any(
            finding.code in codes and not _is_about(finding, missing, declared) for finding in findings
        )
    # With a CMakeLists.txt, another build type is no fault for the diagnosis; but it was not asked for.
    facts["is_ament_python"] &= ("build_type", "ament_python") in [(t, v.strip()) for t, v in tags]
    facts |= {f"declares_{name}": name in declared for name in required}
    facts |= {f"{DECLARED}{name}": name in declared for name in asked if name not in required}
    undeclared = [finding for finding in findings if finding.code == "dependency-undeclared"]
    facts |= {f"declares_{name}": False for finding in undeclared for name in finding.about}
    return facts | {f"{tag}_is_written": is_written for tag, is_written in own_words(text).items()}


def own_words(manifest: str) -> dict[str, bool]:
    """Return whether description, license and maintainer in a package.xml were written by the author."""
    written = {tag: _between(manifest, tag) for tag in ("description", "license", "maintainer")}
    facts = {tag: bool(text) and not is_to_be_done(text) for tag, text in written.items()}
    facts["description"] &= describes(html.unescape(written["description"]), _between(manifest, "name"))
    addresses = re.findall(r"<maintainer\b[^<>]*email\s*=\s*[\"']([^\"'<>]*)", manifest)
    facts["maintainer"] &= not any("todo" in address.lower() for address in addresses)
    facts["maintainer"] &= not any(map(names_its_reader, (written["maintainer"], *addresses)))
    return facts


def _is_about(finding: Finding, missing: Iterable[str], declared: Iterable[str]) -> bool:
    """Return whether a finding says that a required package is not declared, or is misspelt."""
    names = {*missing}
    if finding.code == "dependency-unknown":
        names = {package for package in declared if any(is_near_miss(package, name) for name in names)}
    elif finding.code != "dependency-undeclared":
        return False
    return not names.isdisjoint(finding.about)


def _between(text: str, tag: str) -> str:
    """Return the text of an element, without the tags in it."""
    match = re.search(rf"<{tag}\b[^<>]*>(?:((?s:.{{0,5000}}?))</{tag}\s*>|([^<]*))", text)
    inner = (match[1] or match[2] or "") if match else ""
    return re.sub(r"<!\[CDATA\[|\]\]>|<[^<>]*>", " ", inner).strip()


def setup_facts(package: Package) -> dict[str, bool]:
    """Return the facts of setup.py, setup.cfg and what they name."""
    setup = package.setup
    if setup is None:
        return {"is_there": False}
    facts = _packaging_facts(package, setup)
    name = setup.keywords.get("name")
    facts["name_agrees"] = not isinstance(name, str) or _normal(name) == _normal(package.name)
    if not facts["name_agrees"]:
        # Only one of the two names is wrong; whatever agrees with the other is right.
        renamed = Package(package.folder, package.root)
        renamed.name = str(name)
        renamed_facts = _packaging_facts(renamed, setup)
        facts |= renamed_facts if sum(renamed_facts.values()) > sum(facts.values()) else {}
    if setup.call is None:
        text = "\n".join(read_text(package.folder / name) for name in ("setup.py", "setup.cfg"))
        facts |= {fact: word in text for fact, word in _TRACES.items()}
        facts["is_described"] &= not is_to_be_done(text)
    return facts


def _packaging_facts(package: Package, setup: SetupScript) -> dict[str, bool]:
    codes = {
        finding.code
        for finding in packaging_faults(package)
        # A missing package.xml is a fact of its own.
        if package.has("package.xml") or "package.xml" not in finding.about
    }
    facts = {"is_there": True}
    facts |= {fact: not codes & fault_codes for fact, fault_codes in SETUP_FINDINGS.items()}
    if facts["is_valid"] and setup.entry_points == [] and not setup.keywords.get("scripts"):
        facts["has_entry_points"] = False
    facts["installs_modules"] &= _installs_code(package, setup)
    facts["has_code"] = facts["installs_modules"] or any(
        read_text(path).strip() for path in written_modules(package.folder)
    )
    facts["entry_points_are_own"] = _are_own(package, setup)
    facts["marker_exists"] = package.has(f"resource/{package.name}")
    facts["manifest_is_installed"] = _installs_manifest(package, setup)
    words = [setup.keywords.get(key) for key in ("description", "license", "maintainer", "maintainer_email")]
    facts["is_described"] = not any(isinstance(word, str) and is_to_be_done(word) for word in words)
    facts["is_described"] &= not any(isinstance(word, str) and names_its_reader(word) for word in words[2:])
    if isinstance(words[0], str) and words[0].strip():  # it may be left out: package.xml has it, too
        facts["is_described"] &= describes(words[0], package.name)
    return facts


def _installs_code(package: Package, setup: SetupScript) -> bool:
    """Return whether setup.py installs a module that is not empty; True if that is not known."""
    if package.notes or package.packages is None or setup.keywords.get("py_modules"):
        return True
    return any(source.text.strip() for source in package.sources.values())


def _are_own(package: Package, setup: SetupScript) -> bool:
    """Return whether the entry points name modules of this package, in whatever folder of it."""
    stems = {path.stem for path in written_modules(package.folder)}
    tops = {package.name, *(package.packages or ()), *package.package_dirs}
    return all(
        top in tops or (top in stems and not rest)
        for point in setup.entry_points or ()
        for top, _, rest in [point.module.partition(".")]
        if top.isidentifier()
    )


def _normal(name: str) -> str:
    """Return a name in the normalised form in which Python packaging compares names."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _installs_manifest(package: Package, setup: SetupScript) -> bool:
    known = setup.data_files
    if known is None or not getattr(setup, "are_data_files_known", True):
        return True
    target = f"share/{package.name}"
    return any(where == target and "package.xml" in map(os.path.normpath, files) for where, files in known)
