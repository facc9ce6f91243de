"""What secateur raises. The message of each is one sentence: what is wrong, and what to do."""


class Error(Exception):
    """Anything that secateur refuses."""


class InputError(Error, ValueError):
    """The input does not allow it: a file is not what it should be, or cannot become what is asked for."""


class UsageError(Error, ValueError):
    """It was asked for wrongly: a keyword is unknown, a value out of its range, an array of the wrong shape."""


class MachineError(Error, RuntimeError):
    """The machine does not allow it: memory, disk, GPU."""


class Cancelled(Error):
    """The event given as ``cancel`` was set; nothing was written."""
