/* Prescribed displacements: the input of assembly. The arrays are the caller's. */
#pragma once

#include "approx/shape/boundary.h"
#include "solid/constraint/measured.h"
#include "solid/system/kinds.h"

/* A prescribed displacement, of averages over facets or of values at nodes. */
struct condition {
    const char *name;
    const char *where;       /* prefix of messages about it: "brain.scene:12: [displacement skull]" */
    struct facet_set facets; /* or, where there are none, */
    const int32_t *nodes;    /* node_count: ascending */
    int64_t node_count;
    enum condition_kind kind;
    double components[3]; /* m, dim of them */
    bool is_free[3];      /* CONDITION_COMPONENTS: this one is not prescribed */
    double normal;        /* CONDITION_NORMAL: along the outward normal at rest, m */
    int64_t row_count;    /* CONDITION_TABLE: measured points: */
    const double *rows;   /* row_count * 2 dim: coordinates, then displacement, */
    double unit;          /* in units of so many m */
    const char *table;    /* its name, for messages */
    int32_t curve;
    /* CONDITION_POINTS, which uses only the names and the curve of the above: */
    struct measured measured; /* points anywhere in the body */
    const int64_t *line;      /* measured.count: line of each in its table */
    struct neighbours field;  /* at each point: the nodes of the field, */
    const double *field_phi;  /* and their shape functions */
    double model_error;       /* see measured.h, m; 0: root mean square of the measured components */
};
