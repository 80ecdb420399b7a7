//! Nothing: the C library of the dependency is what is wanted.
