"""Measurements: the codecs beside each other and beside other tools."""
