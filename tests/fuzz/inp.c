/* Fuzz target: decks of Abaqus and CalculiX. */
#include "mesh.h"
