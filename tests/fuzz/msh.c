/* Fuzz target: meshes of gmsh. */
#include "mesh.h"
