"""Files of other programs: universal files, MATLAB, time records, and what they mean here."""
