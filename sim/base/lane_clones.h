// Loops that are compiled for two instruction sets.
#pragma once

/// The one that the machine has is chosen at run time; both do the same operations in every lane. For functions that inline all
/// that they call in their loops.
#define SUPPLE_LANES __attribute__((target_clones("arch=x86-64-v4", "default")))
