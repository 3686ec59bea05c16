"""Whether the README is about this package and true of it, and whether the code is described."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import PurePosixPath

from ros2lab.grading.judging.players import Case
from ros2lab.grading.judging.readme import is_typed
from ros2lab.grading.judging.readme_owners import Owners, is_of_ros_1, is_placeholder
from ros2lab.grading.questions.answer import Answer, listed, question, shown
from ros2lab.grading.questions.launching import excuse

_HEADLINE = re.compile(r"^#.*$|^.*\n[=-]{3,}$", re.MULTILINE)
SHORTEST = 150  # characters of a README that says more than a headline
MOST, SOME = 0.6, 0.3  # of the classes and functions
LEAST_TEXTS, LEAST_ABOUT = 10, 0.25  # docstrings and comments, and how many of them are about the code
_NOTHING = "a topic or a node that was seen to do what was asked for"

# A container or a script of the student's may do both; we do not try what it does.
_BY_OTHERS = r"(?:docker|podman)(?:[ -]compose)? +(?:build|run|up|exec)\b|^\W*(?:bash +)?\./?\S+\.sh\b"
# Commands that set up and run, besides those of colcon and ROS.
_SET_UP = re.compile(rf"pip +install|rosdep|python3? +-m +venv|{_BY_OTHERS}", re.IGNORECASE | re.MULTILINE)
_RUN = re.compile(rf"python3? +[^\s<]*(?:\.py|-m)|lib/\w+/\w+|{_BY_OTHERS}", re.MULTILINE)
_STARTS = ("ros2 run ", "ros2 launch ")
NEARLY_ALL = 0.75  # of the commands of a README that is nearly true
LEAST_WORDS = 2  # of a README's own, as of a description
_CODE = re.compile(r"^ *(```|~~~).*?(?:^ *\1|\Z)|`[^`\n]+`", re.DOTALL | re.MULTILINE)
_COMMENT = re.compile(r"(?<!\S)#.*")
_RUN_ON = re.compile(r"[\w./:-]+", re.ASCII)
# In what is written as names of code, topics, files and addresses are.
_OF_CODE = re.compile(r"[_/]|\w\.\w|[a-z][A-Z]", re.ASCII)
_WORD = re.compile(r"[^\W\d_a-zA-Z]|[^\W\d_]{2,}")  # in some scripts, a single letter is a word
_NAME_ENDS = r"(?!_?[A-Za-z0-9])"  # letters of scripts that use no spaces may follow


@question("this thin older another nothing missing", "package fault foreign")
def readme_is_about_this_package(case: Case) -> Answer:
    """Whether there is a README that says something about this package."""
    text, foreign = case.evidence.files.readme, case.evidence.files.readme_foreign
    seen = {"package": shown(case.package), "fault": "", "foreign": listed(foreign)}
    if not _HEADLINE.sub("", text).strip():
        return Answer("missing", seen, ("files.readme",), "README")
    if not _has_code(case):
        return Answer("nothing", seen, ("files.readme", "build.executables"), "README")
    told = _told(case)
    words = _names(case) | {topic.lstrip("/") for topic in _topics(case)}
    is_named = any(_is_named(word, _without_open_commands(case)) for word in words)
    is_ours = is_named or (case.evidence.files.readme_names and not foreign)
    is_thin = len(" ".join(told.split())) < SHORTEST
    level = "thin" if is_thin else "another" if not is_ours else "older" if foreign else "this"
    if _is_another(case):
        level = "another"
    if level == "another":
        named = "it names nothing of this one: no node, topic, class or file"
        fault = (
            "none of the commands that it gives starts or shows anything of this one" if is_ours else named
        )
        seen["fault"] = f"seems to be about no package or another one, for {fault}"
    return Answer(level, seen, ("files.readme",), "README")


def _without_open_commands(case: Case) -> str:
    """Return a README's text without the commands that its reader must complete, as a template has them."""
    text = case.evidence.files.readme
    for command in case.evidence.files.readme_commands:
        if any(map(is_placeholder, command.split()[2:4])):
            text = re.sub(r"\s+".join(map(re.escape, command.split())), " ", text)
    return text


@question("true excused few_wrong partly some_wrong wrong nothing none", "wrong lacking untried")
def readme_commands_are_true(case: Case) -> Answer:
    """Whether the README says how to set up and to run, and whether that works.

    A command that fails because of a fault in the package or a node costs nothing here.
    """
    files = case.evidence.files
    started = [text for text in files.readme_commands if text.startswith(_STARTS)]
    failed = _failed(case)
    wrong = [*failed.misgiven, *failed.wrong]
    needed, lacking = _lacking(case, started)
    if not _has_code(case):
        level = "nothing" if files.readme else "none"
    elif len(lacking) == needed:
        level = "wrong" if started else "none"
    elif wrong:
        level = _level_of_wrong(files.readme_commands, failed, is_whole=not lacking)
    else:
        level = "partly" if lacking else "excused" if failed.excused else "true"
    told = [_with_its_signs(text, files.readme) for text in wrong or failed.excused or started]
    seen = {"wrong": listed(told), "lacking": listed(lacking)}
    seen["untried"] = _untried(case, started, failed.needing)
    return Answer(level, seen, ("files.readme_commands",), "README")


def _with_its_signs(text: str, readme: str) -> str:
    """Return a command, with why a shell does not take it, if that cannot be seen."""
    return text if is_typed(text, readme) else f"{text} (look-alike spaces or letters)"


@dataclass(frozen=True)
class _Failed:
    """The commands of a README that do not work.

    Attributes:
        needing: those that could not be tried here, with the reasons.
        misgiven: those with wrong operands.
        wrong: the others.
        excused: those that fail because of a fault in the package or a node.
    """

    needing: dict[str, str]
    misgiven: list[str]
    wrong: list[str]
    excused: list[str]


def _failed(case: Case) -> _Failed:
    found = _Failed({}, [], [], [])
    for text, is_true in case.evidence.files.readme_commands.items():
        if is_true is not False:
            continue
        if why := _needs(case, text):
            found.needing[text] = why
        elif _is_misgiven(case, text):
            found.misgiven.append(text)
        else:
            is_excused = _is_excused(case, text) and is_typed(text, case.evidence.files.readme)
            (found.excused if is_excused else found.wrong).append(text)
    return found


def _level_of_wrong(commands: Mapping[str, bool | None], failed: _Failed, *, is_whole: bool) -> str:
    """Return the level of a README with wrong commands: each with wrong operands spoils a right one.

    Args:
        commands: all commands, and whether each is true.
        failed: those that do not work.
        is_whole: whether it explains each of the tasks.
    """
    wrong = {*failed.misgiven, *failed.wrong}
    starting = {text for text in commands if text.startswith(_STARTS)}
    if (starting and starting <= wrong) or len(commands) - len(wrong) <= len(failed.misgiven):
        return "wrong"
    true = sum(is_true is True for is_true in commands.values())
    is_nearly_true = true > NEARLY_ALL * (true + len(wrong)) and starting.isdisjoint(failed.wrong)
    return "few_wrong" if is_whole and is_nearly_true else "some_wrong"


def _lacking(case: Case, started: Collection[str]) -> tuple[int, list[str]]:
    """Return how many tasks a README must explain, and those that it does not."""
    needed = {"set up": (_SET_UP, ("colcon ",)), "run": (_RUN, _STARTS)}
    if case.evidence.submission.form == "files":  # loose files cannot be built
        del needed["set up"]
    files = case.evidence.files
    typed = [text for text in files.readme_commands if _can_be_typed(case, text)]
    lacking = [
        task
        for task, (pattern, commands) in needed.items()
        if not pattern.search(files.readme) and not any(text.startswith(commands) for text in typed)
    ]
    if "run" not in lacking and started and all(_is_foreign(case, text) for text in started):
        lacking.append("run")
    return len(needed), lacking


def _can_be_typed(case: Case, text: str) -> bool:
    """Return whether a reader can type a command as written, or with a program that the README names."""
    files = case.evidence.files
    match text.split():
        case ["ros2", "run" | "launch", package, *names] if files.readme_commands[text] is None:
            paths = (PurePosixPath(path).name for path in files.launch_files)
            is_open = any(map(is_placeholder, names[:1]))
            is_told = not is_open or _is_any_named({*_programs(case), *paths}, files.readme)
            return is_told and not is_placeholder(package) and not _is_foreign(case, text)
        case ["colcon", *words]:
            return not any(map(is_placeholder, words))
    return True


def _untried(case: Case, started: Collection[str], needing: Mapping[str, str]) -> str:
    """Return which commands were not tried, and why, as the end of a sentence."""
    judged = case.evidence.files.readme_commands
    names = {package.name for package in case.evidence.submission.packages} - _packages(case)
    elsewhere = [text for text in started if judged[text] is None and text.split()[2] in names]
    told = [f"; not tried, for {why}: {shown(text)}" for text, why in needing.items()]
    if elsewhere:
        told.append(f"; not tried, for what they start is not graded: {listed(elsewhere)}")
    return "".join(told)


def _needs(case: Case, text: str) -> str:
    """Return why a command that launches nodes could not be tried here; empty if it could."""
    match text.split():
        case ["ros2", "launch", _, name, *_]:
            paths = case.evidence.files.launch_files
            return next((excuse(case, path) for path in paths if PurePosixPath(path).name == name), "")
    return ""


@question("all some none", "unnamed which loosely")
def readme_names_topics_and_nodes(case: Case) -> Answer:
    """Whether the README names the topics and nodes of the package.

    Those that play a part must be named; any other name of the package is better than nothing.
    Names in a text of names alone count only where they stand in a command.
    """
    text, wanted = case.evidence.files.readme, [*_wanted(case)]
    seen = {"unnamed": _NOTHING, "which": "", "loosely": ""}
    if text and not _has_code(case):
        return Answer("none", seen, ("files.readme", "build.executables"), "README")
    if not text or _is_another(case):
        # A README about another package may name the topics and nodes of that one.
        seen |= {"unnamed": "any topic or node", "which": " about this package" if text else ""}
        return Answer("none", seen, ("files.readme",), "README")
    readme, text = text, _told(case)
    is_bare = text != readme
    unnamed = [*dict.fromkeys(subject for subject, names in wanted if not _is_any_named(names, text))]
    unnamed = unnamed if wanted else [_NOTHING]
    is_any = any(_is_any_named(names, text) for _, names in wanted) or _is_any_named(
        _names(case) - {case.package}, text
    )
    level = "all" if not unnamed else "some" if is_any else "none"
    seen |= {"unnamed": listed(unnamed), "which": " with words of its own" if is_bare else ""}
    loose = [
        subject for subject, names in wanted if not any(name.strip("/") in readme for name in names - {""})
    ]
    seen["loosely"] = f", in another spelling {listed(loose)}" if loose else ""
    return Answer(level, seen, ("files.readme",), "README")


@lru_cache(maxsize=1)
def _told(case: Case) -> str:
    """Return the text of a README; only its commands if it has names, but hardly a word that says something of them."""
    files = case.evidence.files
    text = _CODE.sub(lambda code: " ".join(_COMMENT.findall(code[0])), files.readme)
    for command in sorted(files.readme_commands, key=len, reverse=True):
        text = text.replace(command, " ")
    kinds = {part.type_name for part in case.assignment.parts.values()}
    names = {*_names(case), *_topics(case), *_programs(case), *files.readme_names, *kinds}
    known = {word.lower() for name in names for word in _WORD.findall(name.replace("_", " "))}
    text = _RUN_ON.sub(lambda run_on: " " if _OF_CODE.search(run_on[0]) else run_on[0], text)
    own = {word.lower() for word in _WORD.findall(text)} - known
    return files.readme if len(own) >= LEAST_WORDS else "\n".join(files.readme_commands)


def _wanted(case: Case) -> Iterator[tuple[str, set[str]]]:
    """Yield what a README must name, each part's topic and node, with the names that it may use."""
    modules = [executable.stem for executable in case.executables.values()]
    lost = set[str]() if case.has_whole_code_read else case.lost(case.players)
    for name, part in case.assignment.parts.items():
        players = case.players[name]
        # A part that was never written is not there to be described; a node that could not be seen is.
        if not players and (case.written(part) or any(case.may_be(program, part) for program in lost)):
            yield part.topic, {part.topic}
        elif players:
            yield players[0].topic or part.topic, {part.topic, *(player.topic for player in players)}
            names = {player.node.rpartition("/")[2] for player in players}
            names |= {player.program for player in players}
            program = case.executables.get(players[0].program)
            if program and modules.count(program.stem) == 1:
                names.add(program.stem)
            kind = "program" if players[0].is_read else "node"
            yield f"the {kind} {players[0].node}", names


def _is_any_named(names: Collection[str], text: str) -> bool:
    return any(_is_named(name, text) for name in names if name.strip("/"))


@question("most some few foreign nothing none", "described all")
def code_is_described(case: Case) -> Answer:
    """Whether modules, classes and functions have a docstring or a comment; modules without classes need none.

    Where of many hardly one has a word in common with the code or the README, they are about something else.
    """
    sources = case.evidence.files.sources
    modules, classes, functions = (sources.get(kind, [0, 0]) for kind in ("modules", "classes", "functions"))
    is_free = functions[1] and not classes[1]
    pairs = [[modules[0]] * 2 if is_free else modules, classes, functions]
    described, count = sum(pair[0] for pair in pairs), sum(pair[1] for pair in pairs)
    if described and not _has_code(case):
        return Answer("nothing", {"described": "", "all": ""}, ("build.executables",))
    share = described / count if count else 0.0
    level = "most" if share >= MOST else "some" if share >= SOME else "few" if share else "none"
    about, texts = sources.get("about", [0, 0])
    if texts >= LEAST_TEXTS and about / texts < LEAST_ABOUT and level in ("most", "some"):
        level, described, count = "foreign", about, texts
    seen = {"described": str(described), "all": str(count)}
    return Answer(level, seen, ("files.sources",))


def _has_code(case: Case) -> bool:
    """Return whether there is anything to document."""
    return bool(case.executables)


def _names(case: Case) -> set[str]:
    names = {case.package} | {executable.name for executable in case.executables.values()}
    names |= {node.rpartition("/")[2] for run in case.evidence.runs for node in run.nodes}
    return {name for name in names if len(name) > 3}


def _topics(case: Case) -> set[str]:
    played = {player.topic for players in case.players.values() for player in players}
    return {*case.assignment.topics} | played


def _is_named(name: str, text: str) -> bool:
    """Return whether a text has a name, in any case and with spaces or dashes; a topic must end there."""
    words = [re.escape(word) for word in re.split(r"[_\W]+", name) if word]
    pattern = r"[\W_]{0,2}".join(words) + (_NAME_ENDS if name.startswith("/") else "")
    return bool(words) and re.search(pattern, text, re.IGNORECASE) is not None


def _is_another(case: Case) -> bool:
    """Return whether the README has several commands, and none of them names this package or is nearly true of it."""
    owners, commands = _owners(case), case.evidence.files.readme_commands
    if any(owners.of(words) == "own" or owners.own & {*words} for words in map(str.split, commands)):
        return False
    judged = {
        text: bool(is_true) or _is_excused(case, text) or owners.names_program(text.split())
        for text, is_true in commands.items()
        if not text.startswith("colcon") and not is_of_ros_1(text)
        if is_true is not None or _is_foreign(case, text)
    }
    return len(judged) > 1 and not any(judged.values())


def _owners(case: Case) -> Owners:
    return Owners(case.evidence.submission, case.executables.values(), case.evidence.files.launch_files)


def _is_foreign(case: Case, text: str) -> bool:
    """Return whether a command starts something that was not handed in, such as a tool."""
    return _owners(case).of(text.split()) in ("tool", "unknown")


def _is_excused(case: Case, text: str) -> bool:
    """Return whether a command fits the assignment and the files, so that its failure counts elsewhere."""
    match text.split():
        case ["colcon", *_]:
            is_built = case.evidence.build is not None and case.evidence.build.is_built
            return bool(_packages(case)) and not is_built
        case ["ros2", "run", package, name, *_]:
            # The name of a program that is not installed may be meant with or without its ending.
            stem = name.removesuffix(".py")
            is_ours = name in _programs(case) or (
                stem in _programs(case) and not case.is_installed_program(stem)
            )
            return package in _packages(case) and is_ours
        case ["ros2", "launch", package, name, *_]:
            files = {PurePosixPath(path).name for path in case.evidence.files.launch_files}
            return package in _packages(case) and name in files
        case ["ros2", "topic", *words]:
            named = [word for word in words if word.startswith("/")]
            return bool(named) and named[0] in _topics(case)
        case ["ros2", "node" | "param", *words]:
            named = [word.rpartition("/")[2] for word in words if word.startswith("/")]
            return bool(named) and named[0] in _names(case)
    return False


def _is_misgiven(case: Case, text: str) -> bool:
    """Return whether a command has wrong operands, other than the type that the assignment asks for."""
    words = text.split()
    is_asked = any(part.topic in words and part.type_name in words for part in case.assignment.parts.values())
    return text in case.evidence.files.readme_misgiven and not is_asked


def _programs(case: Case) -> set[str]:
    """Return the names of the programs and their modules."""
    return {*case.executables, *(executable.stem for executable in case.executables.values())} - {""}


def _packages(case: Case) -> set[str]:
    """Return the package's names, as its files tell and of its folder; empty if there is no package."""
    package = case.evidence.submission.package
    return {case.package, PurePosixPath(package.folder).name} - {""} if package else set()
