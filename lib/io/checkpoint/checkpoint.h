/* Checkpoints: the state of a run (see base/state.h) as a stream in a file, from which the run can continue.
 *
 * It is a binary stream: section `checkpoint` identifies the run, sections `state.*` hold its values; others
 * are the caller's. */
#pragma once

#include "base/state.h"
#include "io/scene/scene.h"
#include "io/stream/stream.h"

/* Checksums (CRC-32) of the input of a run. A checkpoint with others, or of another version of the programs,
 * is refused. */
struct checkpoint_identity {
    uint32_t scene; /* of the scene's bytes, and of those of the files that it names */
    uint32_t input; /* of the stream's sections */
};

/* Fills in the checksums. Errors of the files that the scene names: as bytefile_read. */
MUST_CHECK enum status checkpoint_identify(const struct scene *scene, const struct stream *input,
                                           struct checkpoint_identity *identity, struct error *error);

/* The checksum of a stream's sections: identity->input. */
uint32_t checkpoint_identify_input(const struct stream *input);

/* Add to a stream the section `checkpoint`; what visits *state is saved there. Numbers and counts are not
 * copied: write the stream before the run continues. */
MUST_CHECK enum status checkpoint_begin(struct stream *stream, const struct checkpoint_identity *identity,
                                        int64_t step, struct state *state, struct error *error);

/* Remove FILE, FILE.frames and FILE.part, which a run that was killed as it wrote leaves, as far as they
 * exist. */
MUST_CHECK enum status checkpoint_remove(const char *file, struct error *error);

/* Read FILE, if it exists. STATUS_INPUT if it is damaged, or of another run. */
MUST_CHECK enum status checkpoint_read(const char *file, const struct checkpoint_identity *identity,
                                       struct stream *stream, bool *exists, int64_t *step,
                                       struct error *error);

/* The state in a stream, from which a run is restored; the stream must outlive it. A visit fails with
 * STATUS_INPUT if a value is missing or of another size. */
struct state checkpoint_state(const struct stream *stream);
