"""What the operating system says of a file, in plain words."""

from __future__ import annotations

import errno

__all__ = ["os_words"]

_WORDS = {
    errno.ENOENT: "it is not there",
    errno.ENOTDIR: "a part of its path is no folder",
    errno.EISDIR: "it is a folder",
    errno.EACCES: "you may not read or write it",
    errno.EPERM: "you may not read or write it",
    errno.ENOSPC: "no space is left on the disk",
    errno.EDQUOT: "your share of the disk is used up",
    errno.EROFS: "the disk can only be read",
    errno.EEXIST: "it is there already",
    errno.ENAMETOOLONG: "its name is too long",
    errno.ELOOP: "its links lead in a circle",
    errno.EIO: "the disk does not answer as it should",
}


def os_words(error: BaseException) -> str:
    """Return why a file could not be used; words of a library are not passed on.

    >>> os_words(OSError(errno.ENOSPC, "No space left on device"))
    'no space is left on the disk'
    >>> os_words(ValueError("embedded null byte"))
    'its name or its content is not as it should be'
    """
    number = error.errno if isinstance(error, OSError) else None
    if number in _WORDS:
        return _WORDS[number]
    said = error.strerror if isinstance(error, OSError) and number is not None else None
    return said[:1].lower() + said[1:] if said else "its name or its content is not as it should be"
