/* Checkpoints: the state of a run (see base/state.h) as a stream in a file, from which the run can go on.
 *
 * The file is replaced as a whole, and the one before it is kept as FILE.old: whenever the program or the
 * machine stops, one of them is whole. It is a binary stream, which mts can show: section `checkpoint`
 * identifies the run, sections `state.*` hold its values; others are the caller's.
 */
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

/* Fills in the checksums. STATUS_SYSTEM when a file that the scene names cannot be read again. */
MUST_CHECK enum status checkpoint_identify(const struct scene *scene, const struct stream *input,
                                           struct checkpoint_identity *identity, struct error *error);

/* The checksum of a stream's sections: identity->input. */
uint32_t checkpoint_identify_input(const struct stream *input);

/* Add the section `checkpoint` and the state that `function` goes through in `owner` to a stream. The values
 * are not copied but where they change their form: write the stream before the run goes on. */
MUST_CHECK enum status checkpoint_fill(struct stream *stream, const struct checkpoint_identity *identity,
                                       int64_t step, state_function *function, void *owner,
                                       struct error *error);

/* Write a stream to FILE.new, bring it to the disk, and rename it to FILE; with `keep_old`, what was there
 * becomes FILE.old. STATUS_SYSTEM on failure, with FILE or FILE.old as good as before. */
MUST_CHECK enum status checkpoint_write(const char *file, bool keep_old, const struct stream *stream,
                                        struct error *error);

/* Remove FILE, FILE.old and FILE.new, those that are there. */
MUST_CHECK enum status checkpoint_remove(const char *file, struct error *error);

/* Where a checkpoint was found. */
enum checkpoint_source { CHECKPOINT_NONE, CHECKPOINT_NEWEST, CHECKPOINT_OLD };

/* Read FILE or, where that is missing or damaged, FILE.old. Neither exists: CHECKPOINT_NONE and an empty
 * stream. Both are damaged, or the one that is whole is of something else: STATUS_INPUT. */
MUST_CHECK enum status checkpoint_read(const char *file, const struct checkpoint_identity *identity,
                                       struct stream *stream, enum checkpoint_source *source, int64_t *step,
                                       struct error *error);

/* The state in a stream, to be handed to a run; the stream must outlive it. A visit fails with STATUS_INPUT
 * where a value is missing or of another size. */
struct state checkpoint_state(const struct stream *stream);
