"""LabVIEW measurement files."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.lvm import LVM_SIGN, lvm_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="LabVIEW measurement",
    holds="every layout of X columns; a section is a hit, or FRFs",
    endings=(".lvm",),
    is_it=lambda head: head.startswith(LVM_SIGN.encode()),
    variables=of_bytes(lvm_variables),
)
