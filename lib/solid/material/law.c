#include "solid/material/law.h"

#include <string.h>

extern const struct law law_neo_hookean, law_neo_hookean_log, law_mooney_rivlin, law_ogden,
    law_st_venant_kirchhoff, law_yeoh, law_trans_iso, law_guccione, law_holzapfel;

const struct law *const material_laws[] = {
    &law_neo_hookean, &law_neo_hookean_log, &law_mooney_rivlin, &law_ogden,     &law_st_venant_kirchhoff,
    &law_yeoh,        &law_trans_iso,       &law_guccione,      &law_holzapfel, NULL};

const int law_count = (int)(sizeof material_laws / sizeof material_laws[0]) - 1;

int law_find(const char *name)
{
    for (int i = 0; material_laws[i] != NULL; i++) {
        if (strcmp(material_laws[i]->name, name) == 0) {
            return i;
        }
    }
    return -1;
}

double law_prepare(const struct law *law, const struct law_input *input, double *parameters,
                   struct law_fault *fault)
{
    if (law->prepare != NULL) {
        return law->prepare(input, parameters, fault);
    }
    return input->by_e ? 0.0 : input->number[0];
}

double law_refuse(struct law_fault *fault, const char *key, const char *what)
{
    *fault = (struct law_fault){key, what};
    return -1.0;
}
