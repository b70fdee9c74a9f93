"""Measure the codecs of mocapress beside each other and beside other compressors."""
