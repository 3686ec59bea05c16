"""What launching writes: to the screen, and to files in a folder of its own for each launch."""

from __future__ import annotations

import datetime
import logging
import os
import socket
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

Output = str | Mapping[str, str | Iterable[str]]
SCREEN_FORMATS = {
    "default": "[{levelname}] [{name}]: {message}",
    "default_with_timestamp": "{created:.7f} [{levelname}] [{name}]: {message}",
}
FILE_FORMAT = "{created:.7f} [{levelname}] [{name}]: {message}"
_ALIASES: dict[str, dict[str, set[str]]] = {
    "screen": {"both": {"screen"}},
    "log": {"both": {"log"}, "stderr": {"screen"}},
    "both": {"both": {"log", "screen"}},
    "own_log": {"both": {"own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
    "full": {"both": {"screen", "log", "own_log"}, "stdout": {"own_log"}, "stderr": {"own_log"}},
}


class LaunchConfig:
    """Where and how launching writes."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the folder and all loggers."""
        self._folder: str | None = None
        self._files: dict[tuple[str, str], logging.Handler] = {}
        # Loggers of our own: what a launch file does to Python's logging changes nothing here.
        self.root = logging.RootLogger(logging.INFO)
        self.manager = logging.Manager(self.root)
        self.on_closed: Callable[[], None] | None = None
        self.screen = _Screen(self)
        self.set_screen_format(os.environ.get("OVERRIDE_LAUNCH_SCREEN_FORMAT") or "default")
        self.plain_screen = _Screen(self)
        self.root.addHandler(self.screen)
        self.root.addHandler(_WhenWritten(self))

    @property
    def level(self) -> int:
        """The least severity that is written."""
        return self.root.level

    @level.setter
    def level(self, level: int) -> None:
        self.root.setLevel(level)

    def set_screen_format(self, screen_format: str) -> None:
        """Write to the screen in this format: an alias or a `{`-style logging format."""
        text = SCREEN_FORMATS.get(screen_format) or screen_format.encode().decode("unicode_escape")
        self.screen.setFormatter(logging.Formatter(text.replace("{msg}", "{message}"), style="{"))

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

    def get_log_file_path(self, file_name: str = "launch.log") -> str:
        """Return the path of a file in the folder of this launch."""
        return str(Path(self.log_dir, file_name))

    def file_handler(self, file_name: str, text_format: str) -> logging.Handler:
        """Return what writes to a file in the folder of this launch."""
        key = (file_name, text_format)
        if key not in self._files:
            handler = logging.FileHandler(
                self.get_log_file_path(file_name), encoding="utf-8", errors="replace"
            )
            handler.setFormatter(logging.Formatter(text_format, style="{"))
            self._files[key] = handler
        return self._files[key]

    def close(self) -> None:
        """Close the files."""
        while self._files:
            self._files.popitem()[1].close()


class _Screen(logging.Handler):
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


class _WhenWritten(logging.Handler):
    """The main log file, made when there is something to write."""

    def __init__(self, config: LaunchConfig) -> None:
        super().__init__()
        self.config = config

    def emit(self, record: logging.LogRecord) -> None:
        self.config.file_handler("launch.log", FILE_FORMAT).emit(record)


launch_config = LaunchConfig()


def get_logger(name: str | None = None) -> logging.Logger:
    """Return a logger that writes to the screen and to the main log file."""
    return launch_config.manager.getLogger(name) if name else launch_config.root


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
    logger.propagate = False
    own, shared = config.get(source, set()), config.get("both", set())
    if "screen" in own | shared:
        logger.addHandler(launch_config.plain_screen)
    if "log" in own | shared:
        logger.addHandler(launch_config.file_handler("launch.log", "{created:.7f} {message}"))
    if "own_log" in own:
        logger.addHandler(launch_config.file_handler(f"{process_name}-{source}.log", "{message}"))
    if "own_log" in shared:
        logger.addHandler(launch_config.file_handler(f"{process_name}.log", "{message}"))
    return logger


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
