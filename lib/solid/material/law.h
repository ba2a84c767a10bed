/* Material laws: what each one is called, its parameters as a scene names them, and its energy and stress at
 * a point. A law is one file, which defines a struct law, and its line in the table of law.c. */
#pragma once

#include "solid/material/material.h"

#include <float.h>

enum { LAW_NUMBERS = 12, LAW_KEYS = 7 }; /* most numbers and keys of a law */

/* When a key is allowed: the stiffness of a law is given by E, or by parameters in Pa. */
enum law_form { LAW_ALWAYS, LAW_WITH_E, LAW_WITHOUT_E };

struct law_key {
    const char *name;
    const char *remedy; /* if it is missing; NULL: it is optional, and 0 by default */
    enum law_form form;
    double least, most; /* range of its numbers; */
    bool open;          /* without `least` itself */
    int count;          /* most numbers in its list */
};

/* Ranges of keys, and the count 1. */
#define LAW_POSITIVE 0.0, DBL_MAX, true, 1
#define LAW_NOT_NEGATIVE 0.0, DBL_MAX, false, 1
#define LAW_ANY -DBL_MAX, DBL_MAX, false, 1

enum law_volume { LAW_VOLUME_LINEAR, LAW_VOLUME_LOG, LAW_VOLUME_NONE }; /* y = J - 1; ln J; U = 0 */

/* The numbers of the keys of a section, in the order of the keys: those of key k begin at the sum of the
 * counts of the keys before it. What is not given is 0. */
struct law_input {
    bool by_e; /* the shear modulus comes from E */
    int given[LAW_KEYS];
    double number[LAW_NUMBERS];
};

/* Why numbers are refused. */
struct law_fault {
    const char *key, *what;
};

struct law {
    const char *name;
    const struct law_key *keys; /* the last one has no name */
    bool by_e;                  /* its stiffness may be given by E */
    enum law_volume volume;
    bool has_fibres;
    bool slackens;     /* fibres bear no pressure: the stress has a kink where they are as long as at rest */
    const char *plane; /* the key that, if given, needs the plane of two families of fibres; NULL: none */
    /* From a section's numbers, within their ranges, to the law's parameters relative to the shear modulus at
     * rest, which is returned, Pa; 0 where that comes from E; negative: *fault says why the law has none, as
     * where it is not elliptic at rest. With fibres the shear modulus is mu of the tangent 2 mu e:e for
     * isochoric e that is nearest to that of the law: a fifth of the sum of its eigenvalues, halved. NULL: no
     * parameters but the shear modulus. */
    double (*prepare)(const struct law_input *input, double *parameters, struct law_fault *fault);
    /* Set the moduli at rest, and the families unless they are one along material->fibre; NULL: there are no
     * fibres. */
    void (*rest)(const struct material *material, struct material_rest *rest);
    /* W_iso where det F > 0, and P = dW_iso/dF; NaN or infinite where the law has none. */
    double (*energy)(const struct material *material, const double F[9]);
    void (*stress)(const struct material *material, const double F[9], double P[9]);
};

/* The laws by number; the last one is NULL. A scene's default is the first. */
extern const struct law *const material_laws[];
extern const int law_count;

/* The number of the law of that name, or -1. */
int law_find(const char *name);

/* law->prepare, or for a law without one the shear modulus from its key mu. */
double law_prepare(const struct law *law, const struct law_input *input, double *parameters,
                   struct law_fault *fault);
/* -1, and why. */
double law_refuse(struct law_fault *fault, const char *key, const char *what);

/* ---- what laws are made of ---- */

/* mu may be a function of I1', as the slope of a law in I1' alone is (yeoh.c). */
double neo_hookean_energy(double mu, const double F[9]);
void neo_hookean_stress(double mu, const double F[9], double P[9]);
/* c1 (I1' - 3) + c2 (I2' - 3) */
double mooney_energy(double c1, double c2, const double F[9]);
void mooney_stress(double c1, double c2, const double F[9], double P[9]);

/* frame[6]: unit vectors along the fibres and across them in the plane that `plane` spans with `along`; in 2D
 * that of the body, and zeros if `plane` is NULL. false if one of the two has no direction. */
bool fibre_frame(int dim, const double along[3], const double *plane, double frame[6]);

/* J^(-2/3) of F; with it I4' = J^(-2/3) |F a|^2 of the unit vector a, and P += slope dI4'/dF. */
double isochoric_scale(const double F[9]);
double fibre_square(double scale, const double F[9], const double a[3]);
void add_fibre_stress(double scale, const double F[9], const double a[3], double slope, double P[9]);
