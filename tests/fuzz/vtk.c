/* Fuzz target: files of VTK, in XML and legacy. */
#include "mesh.h"
