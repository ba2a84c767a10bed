/* Several processes on one body: here threads stand for them, each with a body of its own. What they compute
 * together has the bits of one process, whatever their number. */
#include "body_setup.h"

#include "base/ranks.h"

#include <pthread.h>

enum { MOST = 7 };

/* What a process has begun to receive. */
struct exchange {
    size_t size;
    void *receive;
    const int64_t *receive_first;
};

/* What the threads that stand for processes share. */
struct team {
    int count;
    pthread_barrier_t barrier;
    const void *items[MOST]; /* of each process */
    const int64_t *first[MOST];
    struct exchange begun[MOST];
    int64_t value[MOST];
    pthread_mutex_t lock;
    pthread_cond_t changed;
    const double *letter[MOST]; /* for each process; NULL: none */
};

struct member {
    struct ranks ranks;
    const struct sample *sample;
    const struct setup *setup;
    const double *u;
    double *results; /* of the team's member 0 .. count - 1 in turn */
    int64_t *count;  /* of results */
};

static void wait_for_all(const struct ranks *ranks)
{
    pthread_barrier_wait(&((struct team *)ranks->context)->barrier);
}

static void gather(const struct ranks *ranks, void *items, size_t size, const int64_t *first)
{
    struct team *team = ranks->context;
    team->items[ranks->rank] = items;
    wait_for_all(ranks);
    for (int r = 0; r < ranks->count; r++) {
        size_t at = (size_t)(first != NULL ? first[r] : r) * size;
        size_t count = (size_t)(first != NULL ? first[r + 1] - first[r] : 1);
        if (r != ranks->rank) {
            memcpy((char *)items + at, (const char *)team->items[r] + at, count * size);
        }
    }
    wait_for_all(ranks);
}

static void begin(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                  void *receive, const int64_t *receive_first)
{
    struct team *team = ranks->context;
    team->items[ranks->rank] = send;
    team->first[ranks->rank] = send_first;
    team->begun[ranks->rank] = (struct exchange){size, receive, receive_first};
}

static void finish(const struct ranks *ranks)
{
    struct team *team = ranks->context;
    struct exchange *mine = &team->begun[ranks->rank];
    wait_for_all(ranks);
    for (int r = 0; r < ranks->count; r++) {
        memcpy((char *)mine->receive + (size_t)mine->receive_first[r] * mine->size,
               (const char *)team->items[r] + (size_t)team->first[r][ranks->rank] * mine->size,
               (size_t)(mine->receive_first[r + 1] - mine->receive_first[r]) * mine->size);
    }
    wait_for_all(ranks);
}

static void exchange(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                     void *receive, const int64_t *receive_first)
{
    begin(ranks, size, send, send_first, receive, receive_first);
    finish(ranks);
}

static void send_to(const struct ranks *ranks, int to, const double *x, int64_t count)
{
    struct team *team = ranks->context;
    (void)count;
    pthread_mutex_lock(&team->lock);
    team->letter[to] = x;
    pthread_cond_broadcast(&team->changed);
    while (team->letter[to] != NULL) {
        pthread_cond_wait(&team->changed, &team->lock);
    }
    pthread_mutex_unlock(&team->lock);
}

static void receive_from(const struct ranks *ranks, int from, double *x, int64_t count)
{
    struct team *team = ranks->context;
    (void)from;
    pthread_mutex_lock(&team->lock);
    while (team->letter[ranks->rank] == NULL) {
        pthread_cond_wait(&team->changed, &team->lock);
    }
    memcpy(x, team->letter[ranks->rank], (size_t)count * sizeof *x);
    team->letter[ranks->rank] = NULL;
    pthread_cond_broadcast(&team->changed);
    pthread_mutex_unlock(&team->lock);
}

static int64_t most(const struct ranks *ranks, int64_t value)
{
    struct team *team = ranks->context;
    team->value[ranks->rank] = value;
    wait_for_all(ranks);
    for (int r = 0; r < ranks->count; r++) {
        value = team->value[r] > value ? team->value[r] : value;
    }
    wait_for_all(ranks);
    return value;
}

/* Run `work` on so many members at once. */
static void run_team(int count, struct member *members, void *(*work)(void *member))
{
    struct team team = {.count = count};
    pthread_t threads[MOST];
    pthread_barrier_init(&team.barrier, NULL, (unsigned)count);
    pthread_mutex_init(&team.lock, NULL);
    pthread_cond_init(&team.changed, NULL);
    for (int r = 0; r < count; r++) {
        members[r].ranks =
            (struct ranks){count, r, gather, exchange, begin, finish, send_to, receive_from, most, &team};
        assert_int_equal(pthread_create(&threads[r], NULL, work, &members[r]), 0);
    }
    for (int r = 0; r < count; r++) {
        assert_int_equal(pthread_join(threads[r], NULL), 0);
    }
    pthread_cond_destroy(&team.changed);
    pthread_mutex_destroy(&team.lock);
    pthread_barrier_destroy(&team.barrier);
}

/* Forces, energy, least J, bounds of the stiffness, stresses, gradients and volume ratios of a body at u:
 * returns how many numbers. */
static int64_t evaluate(struct body *body, const double *u, double *results)
{
    double *at = results;
    int64_t nodes = body->node_count, points = body->point_count;
    struct deformation deformation = body_force(body, u, at);
    at += nodes * body->dim;
    *at++ = deformation.least_jacobian;
    *at++ = (double)deformation.point;
    body_diagonal(body, at);
    at += nodes;
    if (body->smoothed) {
        body_nodal_diagonal(body, true, at);
        at += nodes;
    }
    body_stress(body, at);
    at += points * 9;
    body_gradient(body, at);
    at += points * 9;
    body_volume_ratio(body, at);
    at += points;
    *at++ = body_energy(body, u);
    body_limit_bulk(body, 2.0);
    (void)body_force(body, u, at);
    if (body_is_limited(body)) {
        (void)body_augment(body, false, 0.0, 0.0);
        (void)body_force(body, u, at);
    }
    return at + nodes * body->dim - results;
}

static int64_t room(const struct sample *sample)
{
    return 8 * sample->cloud.node_count * sample->dim + 20 * sample->assembly.point_count + 8;
}

static void *evaluate_member(void *context)
{
    struct member *member = context;
    struct setup setup = *member->setup;
    setup.ranks = &member->ranks;
    omp_set_num_threads(1); /* of this thread's regions */
    FREED_BY(body_free) struct body body = make_body(member->sample, &setup);
    member->count[member->ranks.rank] =
        evaluate(&body, member->u, member->results + member->ranks.rank * room(member->sample));
    return NULL;
}

static void check_body(const struct sample *sample, const struct setup *setup, struct random *random)
{
    static const int counts[] = {2, 3, MOST};
    int64_t some = room(sample);
    double *force = zeros(sample->cloud.node_count * sample->dim, sizeof *force);
    double *alone = zeros(some, sizeof *alone), *results = zeros(some * MOST, sizeof *results);
    FREED_BY(body_free) struct body body = make_body(sample, setup);
    double *u = deformed_field(sample, &body, force, random);
    int64_t count = evaluate(&body, u, alone);
    assert_true(count > 0 && count <= some && largest(alone, count) > 0.0);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct member members[MOST];
        int64_t have[MOST];
        int team = counts[i];
        for (int r = 0; r < team; r++) {
            members[r] =
                (struct member){.sample = sample, .setup = setup, .u = u, .results = results, .count = have};
        }
        memset(results, 0, (size_t)(some * MOST) * sizeof *results);
        run_team(team, members, evaluate_member);
        for (int r = 0; r < team; r++) {
            assert_int_equal(have[r], count);
            assert_memory_equal(results + r * some, alone, (size_t)count * sizeof *alone);
        }
    }
}

/* Every kind of body, by 2, 3 and 7 processes, of which some have nothing to do. */
TEST(bodies)
{
    for_all(check_body);
}

/* Larger: bodies of many blocks, whose bounds are summed in parts that go from process to process. */
TEST(large_body)
{
    struct random random = {3};
    FREED_BY(sample_free) struct sample sample = make_sample(2, true, 60);
    struct setup setup = three_materials(true);
    setup.faces = true;
    check_body(&sample, &setup, &random);
}

/* Stretches are of about the same work, cover all items in turn, and say whose an item is. */
TEST(shares)
{
    struct ranks ranks = {.count = 3};
    const double work[8] = {4.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 4.0};
    int64_t *first;
    GOOD(ranks_share(&ranks, 8, work, &first, &error));
    assert_int_equal(first[0], 0);
    assert_int_equal(first[3], 8);
    assert_true(first[1] >= 1 && first[1] <= 3 && first[2] == 7);
    for (int64_t i = 0; i < 8; i++) {
        int owner = ranks_owner(&ranks, first, i);
        assert_true(first[owner] <= i && i < first[owner + 1]);
    }
    free(first);
    GOOD(ranks_share(&ranks, 1, NULL, &first, &error)); /* fewer items than processes */
    assert_int_equal(first[3], 1);
    assert_int_equal(first[ranks_owner(&ranks, first, 0)], 0);
    free(first);
    GOOD(ranks_share(NULL, 5, NULL, &first, &error));
    assert_int_equal(first[1], 5);
    free(first);
    assert_int_equal(ranks_most(NULL, 3), 3);
}

TEST(rows_in_stretches)
{
    struct row_ranges ranges;
    const bool wanted[9] = {true, true, false, true, false, false, true, true, true};
    GOOD(row_ranges_of(1, 8, wanted, &ranges, &error));
    assert_int_equal(ranges.count, 3);
    assert_true(ranges.items[0].begin == 1 && ranges.items[0].end == 2);
    assert_true(ranges.items[2].begin == 6 && ranges.items[2].end == 8);
    row_ranges_free(&ranges);
    GOOD(row_ranges_of(0, 2 * ROW_RANGE_MOST + 1, NULL, &ranges, &error));
    assert_int_equal(ranges.count, 3);
    assert_true(ranges.items[2].begin == 2 * ROW_RANGE_MOST && ranges.items[2].end == 2 * ROW_RANGE_MOST + 1);
    row_ranges_free(&ranges);
}

/* What the first that fails says, all know; the values of all, in turn. */
static void *agree_member(void *context)
{
    struct member *member = context;
    const struct ranks *ranks = &member->ranks;
    struct error said = {"?"};
    SCRATCH int64_t *each = NULL;
    GOOD(ranks_agree(ranks, STATUS_OK, &error));
    enum status status =
        ranks->rank > 0 ? (fail)(&said, STATUS_INPUT + (ranks->rank > 1), "by %d", ranks->rank) : STATUS_OK;
    assert_int_equal(ranks_agree(ranks, status, &said), STATUS_INPUT);
    assert_string_equal(said.text, "by 1");
    GOOD(ranks_list(ranks, 10 + ranks->rank, &each, &error));
    for (int r = 0; r < ranks->count; r++) {
        assert_int_equal(each[r], 10 + r);
    }
    return NULL;
}

TEST(agreement)
{
    struct member members[3] = {{.sample = NULL}};
    run_team(3, members, agree_member);
    FAILS(ranks_agree(NULL, (fail)(&error, STATUS_VERDICT, "alone"), &error), STATUS_VERDICT, "");
}

RUN_TESTS(make_samples, free_samples)
