"""Commands of the command line: a module for each, beside it what it prints."""
