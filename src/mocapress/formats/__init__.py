"""Motion files: AMC with ASF, and BVH; read, written, and taken apart byte for byte."""
