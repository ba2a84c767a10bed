/* Fuzz target: models of FEBio. */
#include "mesh.h"
