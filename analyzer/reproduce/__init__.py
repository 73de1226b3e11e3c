"""Published figures of three papers and a later data set beside ours."""
