"""The measured session: records, journal, HDF5 layout."""
