"""TDMS files of National Instruments."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.tdms import tdms_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="TDMS",
    holds="LabVIEW and DIAdem; a group is a hit, or FRFs. Needs `pip install 'armodal[files]'`",
    endings=(".tdms",),
    is_it=lambda head: head.startswith(b"TDSm"),
    variables=of_bytes(tdms_variables),
)
