"""What launching writes: to the screen, and to files in a folder of its own for each launch."""

from __future__ import annotations

import datetime
import functools
import logging
import os
import socket
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from launch.logging import handlers

Output = str | Mapping[str, str | Iterable[str]]
HandlerFactory = Callable[..., logging.Handler]
FORMATS = {
    "default": "[{levelname}] [{name}]: {message}",
    "default_with_timestamp": "{created:.7f} [{levelname}] [{name}]: {message}",
}
MAIN_FILE = "launch.log"
PLAIN = logging.Formatter("{message}", style="{")
PLAIN_WITH_TIMESTAMP = logging.Formatter("{created:.7f} {message}", style="{")
_ALIASES: dict[str, dict[str, set[str]]] = {
    "screen": {"both": {"screen"}},
    "log": {"both": {"log"}, "stderr": {"screen"}},
    "both": {"both": {"log", "screen"}},
    "own_log": {"both": {"own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
    "full": {"both": {"screen", "log", "own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
}


class LaunchConfig:
    """Where and how launching writes.

    Attributes:
        log_handler_factory: makes the handler of a log file from its path and its `encoding`.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the folder and all loggers."""
        self._folder: str | None = None
        self._files: dict[str, _File] = {}
        # Loggers of our own: what a launch file does to Python's logging changes nothing here.
        self.root = logging.RootLogger(logging.INFO)
        self.manager = logging.Manager(self.root)
        self.on_closed: Callable[[], None] | None = None
        self.log_handler_factory: HandlerFactory = functools.partial(logging.FileHandler, errors="replace")
        self._screen = _Screen(self)
        self.set_screen_format("default")
        self.set_log_format("default")

    @property
    def level(self) -> int:
        """The least severity that is written."""
        return self.root.level

    @level.setter
    def level(self, level: int) -> None:
        self.root.setLevel(level)

    def set_screen_format(self, screen_format: str, *, screen_style: str | None = None) -> None:
        """Write to the screen in this format, unless OVERRIDE_LAUNCH_SCREEN_FORMAT is set.

        Args:
            screen_format: `default`, `default_with_timestamp`, or a format of `logging.Formatter`.
            screen_style: the style of the latter, "{" if None.
        """
        self._screen.setFormatter(_formatter("SCREEN", FORMATS, screen_format, screen_style))

    def set_log_format(self, log_format: str, *, log_style: str | None = None) -> None:
        """Write to the main log file in this format, unless OVERRIDE_LAUNCH_LOG_FORMAT is set."""
        aliases = {"default": FORMATS["default_with_timestamp"]}
        self._file_formatter = _formatter("LOG", aliases, log_format, log_style)
        for file in self._files.values():
            file.setFormatter(self._file_formatter)

    @property
    def log_dir(self) -> str:
        """The folder of this launch; it is made now.

        Raises:
            RuntimeError: if it cannot be made.
        """
        if self._folder is None:
            base = _log_folder()
            now = datetime.datetime.now().strftime("%Y-%m-%d-%H-%M-%S-%f")
            folder = base / f"{now}-{socket.gethostname()}-{os.getpid()}"
            try:
                folder.mkdir(parents=True)
            except OSError as error:
                raise RuntimeError(
                    f"The log folder {folder} cannot be made ({error.strerror}); "
                    "set ROS_LOG_DIR to a folder in which you may write."
                ) from None
            self._folder = str(folder)
            _name_latest(folder)
        return self._folder

    @log_dir.setter
    def log_dir(self, folder: str | None) -> None:
        if folder is not None and not Path(folder).is_dir():
            raise ValueError(f"{folder} is not a directory")
        self._folder = folder

    def get_log_file_path(self, file_name: str = MAIN_FILE) -> str:
        """Return the path of a file in the folder of this launch."""
        return str(Path(self.log_dir, file_name))

    def get_screen_handler(self) -> _Screen:
        """Return what writes to the screen."""
        return self._screen

    def get_log_file_handler(self, file_name: str = MAIN_FILE) -> _File:
        """Return what writes to a file in the folder of this launch, which is made when it has to write."""
        if file_name not in self._files:
            self._files[file_name] = _File(self, file_name)
            self._files[file_name].setFormatter(self._file_formatter)
        return self._files[file_name]

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            file.close()


class _Screen(handlers.Handler):
    """Writes to standard output; when nobody reads it any more, says so once."""

    def __init__(self, config: LaunchConfig) -> None:
        super().__init__()
        self.config = config

    def emit(self, record: logging.LogRecord) -> None:
        text = self.format(record) + "\n"
        encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
        try:
            sys.stdout.write(text.encode(encoding, "replace").decode(encoding))
            sys.stdout.flush()
        except BrokenPipeError:
            # Also what is written at the exit must not fail.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            if self.config.on_closed is not None:
                self.config.on_closed()


class _File(handlers.Handler):
    """A log file, made when there is something to write."""

    def __init__(self, config: LaunchConfig, file_name: str) -> None:
        super().__init__()
        self.config = config
        self._file_name = file_name
        self._opened: logging.Handler | None = None

    def emit(self, record: logging.LogRecord) -> None:
        if self._opened is None:
            path = self.config.get_log_file_path(self._file_name)
            self._opened = self.config.log_handler_factory(path, encoding="utf-8")
        self._opened.setFormatter(self._formatters().get(record.name, self.formatter))
        self._opened.emit(record)

    def flush(self) -> None:
        if self._opened is not None:
            self._opened.flush()

    def close(self) -> None:
        """Close the file; another record opens it again."""
        super().close()
        if self._opened is not None:
            self._opened.close()
            self._opened = None


def _formatter(where: str, aliases: Mapping[str, str], given: str, style: str | None) -> logging.Formatter:
    override = os.environ.get(f"OVERRIDE_LAUNCH_{where}_FORMAT")
    if override:
        given, style = override.encode("latin1", "backslashreplace").decode("unicode_escape"), None
    if given in aliases and style is not None:
        raise ValueError(f"The format '{given}' has a style of its own: give none.")
    return logging.Formatter(_with_message(aliases.get(given, given)), style=style or "{")  # type: ignore[arg-type]


def _with_message(text: str) -> str:
    """Return a format that shows the whole message, as people mean it."""
    return text.replace("{msg}", "{message}")


launch_config = LaunchConfig()


def get_logger(name: str | None = None) -> logging.Logger:
    """Return a logger that writes to the screen and to the main log file."""
    logger = launch_config.manager.getLogger(name) if name else launch_config.root
    _write_to(logger, launch_config.get_screen_handler(), launch_config.get_log_file_handler())
    return logger


def reset() -> None:
    """Begin anew, with another folder."""
    launch_config.close()
    launch_config.reset()


def log_launch_config(*, logger: logging.Logger) -> None:
    """Tell where the log files are."""
    logger.info("All log files can be found below %s", launch_config.log_dir)
    logger.info("Default logging verbosity is set to %s", logging.getLevelName(launch_config.level))


def get_output_loggers(process_name: str, output_config: Output) -> tuple[logging.Logger, logging.Logger]:
    """Return the loggers of what a process writes to its standard output and standard error.

    Args:
        process_name: the name of the process.
        output_config: "screen", "log", "both", "own_log" or "full"; or a dictionary with the keys "stdout",
            "stderr" and "both" and one or more of "screen", "log" and "own_log" for each.

    Raises:
        ValueError: if the configuration is none of these.
    """
    config = _normalized(output_config)
    return _output_logger(process_name, "stdout", config), _output_logger(process_name, "stderr", config)


def _output_logger(process_name: str, source: str, config: dict[str, set[str]]) -> logging.Logger:
    logger = launch_config.manager.getLogger(f"{process_name}-{source}")
    own, shared = config.get(source, set()), config.get("both", set())
    screen, main_file = launch_config.get_screen_handler(), launch_config.get_log_file_handler()
    screen.setFormatterFor(logger, PLAIN)
    main_file.setFormatterFor(logger, PLAIN_WITH_TIMESTAMP)
    written: list[handlers.Handler] = [screen] if "screen" in own | shared else []
    if "log" in own | shared:
        written.append(main_file)
    for destinations, file_name in ((own, f"{process_name}-{source}.log"), (shared, f"{process_name}.log")):
        if "own_log" in destinations:
            own_file = launch_config.get_log_file_handler(file_name)
            own_file.setFormatterFor(logger, PLAIN)
            written.append(own_file)
    _write_to(logger, *written)
    return logger


def _write_to(logger: logging.Logger, *written: logging.Handler) -> None:
    """Let the records of a logger go here and nowhere else."""
    logger.propagate = False
    for handler in written:
        logger.addHandler(handler)


def _normalized(config: Output) -> dict[str, set[str]]:
    if isinstance(config, str):
        if config not in _ALIASES:
            raise ValueError(f'{config} is not a valid standard output config i.e. "screen", "log" or "both"')
        return _ALIASES[config]
    if not isinstance(config, Mapping):
        raise ValueError(f"{config} is not a valid output configuration")
    normalized = {}
    for source, given in config.items():
        if source not in ("stdout", "stderr", "both"):
            raise ValueError(f'{source} is not a valid output source i.e. "stdout", "stderr" or "both"')
        normalized[source] = {given} if isinstance(given, str) else set(given)
        for destination in normalized[source] - {"screen", "log", "own_log"}:
            raise ValueError(
                f'{destination} is not a valid output destination i.e. "screen", "log" or "own_log"'
            )
    return normalized


def _log_folder() -> Path:
    folder = os.environ.get("ROS_LOG_DIR")
    if folder:
        return Path(folder).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros", "log").expanduser()


def _name_latest(folder: Path) -> None:
    """Let `latest` lead to the folder; another launch may do the same at this moment."""
    link, new = folder.parent / "latest", folder.parent / f".latest-{os.getpid()}"
    try:
        if link.is_symlink() or not link.exists():
            new.symlink_to(folder, target_is_directory=True)
            new.replace(link)
    except OSError:
        pass  # only a convenience
