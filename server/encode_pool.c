#include "encode_pool.h"

#include <assert.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "encoders/jpeg.h"
#include "import/import.h"

#define SPARE_BUFFERS 4
#define ENCODERS_MAX  16

struct buffer {
    void *data;
    size_t capacity;
};

struct job_list {
    struct encode_job *first, **end;
};

struct encode_pool {
    pthread_mutex_t mutex;
    pthread_cond_t work;
    struct job_list queue, finished;
    size_t pending;
    uint32_t busy_views[ENCODERS_MAX]; /* the view each worker encodes for; 0: none */
    struct buffer spare[SPARE_BUFFERS];
    bool stopping;
    void (*done)(void *context);
    void *context;
    unsigned thread_count;
    pthread_t threads[ENCODERS_MAX];
    struct jpeg_encoder *jpeg[ENCODERS_MAX];
};

struct encode_job *encode_job_create(void) { return calloc(1, sizeof(struct encode_job)); }

void encode_job_destroy(struct encode_job *job)
{
    if (!job)
        return;
    assert(!job->request);
    packet_unref(job->packet);
    free(job->pixels);
    free(job);
}

static void list_push(struct job_list *list, struct encode_job *job)
{
    job->link = NULL;
    *list->end = job;
    list->end = &job->link;
}

static struct encode_job *list_remove(struct job_list *list, struct encode_job **at)
{
    struct encode_job *job = *at;
    *at = job->link;
    if (!job->link)
        list->end = at;
    job->link = NULL;
    return job;
}

static bool make_packet(struct encode_job *job, const uint8_t *payload, size_t size, uint64_t started_us)
{
    job->packet = packet_create(GNMF_HEADER_SIZE + size, true);
    if (!job->packet)
        return error_set(&job->err, ERROR_TRY_AGAIN, NULL, "out of memory for a picture of %zu bytes", size);
    memcpy(job->packet->data + GNMF_HEADER_SIZE, payload, size);
    uint64_t took = clock_us() - started_us;
    job->header.encode_us = took < UINT32_MAX ? (uint32_t)took : UINT32_MAX;
    frame_header_write(&job->header, job->packet->data);
    return true;
}

static enum image_format image_format_of(enum gnmf_codec codec)
{
    return codec == GNMF_PNG ? IMAGE_PNG : codec == GNMF_WEBP ? IMAGE_WEBP : codec == GNMF_EXR ? IMAGE_EXR : IMAGE_JPEG;
}

static void encode(struct encode_job *job, struct jpeg_encoder *jpeg)
{
    uint64_t started = clock_us();
    size_t size;
    /* Streams for speed; a picture on request as `gnomon render` writes it. */
    if (job->header.codec == GNMF_JPEG && !job->request) {
        const uint8_t *bytes;
        if (jpeg_encode(jpeg, job->pixels, job->width, job->height, job->quality, &bytes, &size, &job->err))
            make_packet(job, bytes, size, started);
        return;
    }
    uint8_t *bytes = NULL;
    if (image_encode(image_format_of(job->header.codec), job->pixels, job->width, job->height, job->quality, NULL, 0, &bytes,
                     &size, &job->err))
        make_packet(job, bytes, size, started);
    free(bytes);
}

/* Mutex held. Memory is kept for the next frame, unless enough is. */
static void recycle(struct encode_pool *pool, struct encode_job *job)
{
    struct buffer *smallest = &pool->spare[0];
    for (size_t i = 1; i < SPARE_BUFFERS; i++)
        if (pool->spare[i].capacity < smallest->capacity)
            smallest = &pool->spare[i];
    struct buffer given = {job->pixels, job->pixels_capacity};
    if (given.capacity > smallest->capacity) {
        struct buffer kept = given;
        given = *smallest;
        *smallest = kept;
    }
    free(given.data);
    job->pixels = NULL;
    job->pixels_capacity = 0;
}

bool encode_pool_buffer(struct encode_pool *pool, struct encode_job *job, size_t size)
{
    pthread_mutex_lock(&pool->mutex);
    for (size_t i = 0; i < SPARE_BUFFERS && !job->pixels; i++) {
        struct buffer *spare = &pool->spare[i];
        if (spare->capacity >= size && spare->capacity / 4 <= size) {
            job->pixels = spare->data;
            job->pixels_capacity = spare->capacity;
            *spare = (struct buffer){0};
        }
    }
    pthread_mutex_unlock(&pool->mutex);
    if (!job->pixels && (job->pixels = malloc(size)))
        job->pixels_capacity = size;
    return job->pixels;
}

static uint32_t view_of(const struct encode_job *job) { return job->request ? 0 : job->header.view; }

/* Mutex held. The oldest job whose view no other worker is at. */
static struct encode_job *next_job(struct encode_pool *pool)
{
    for (struct encode_job **at = &pool->queue.first; *at; at = &(*at)->link) {
        uint32_t view = view_of(*at);
        bool busy = false;
        for (unsigned i = 0; i < pool->thread_count && view; i++)
            busy |= pool->busy_views[i] == view;
        if (!busy)
            return list_remove(&pool->queue, at);
    }
    return NULL;
}

struct worker_start {
    struct encode_pool *pool;
    unsigned index;
};

static void *worker_main(void *argument)
{
    struct worker_start start = *(struct worker_start *)argument;
    struct encode_pool *pool = start.pool;
    free(argument);
    pthread_mutex_lock(&pool->mutex);
    while (!pool->stopping) {
        struct encode_job *job = next_job(pool);
        if (!job) {
            pthread_cond_wait(&pool->work, &pool->mutex);
            continue;
        }
        pool->busy_views[start.index] = view_of(job);
        pthread_mutex_unlock(&pool->mutex);
        encode(job, pool->jpeg[start.index]);
        pthread_mutex_lock(&pool->mutex);
        pool->busy_views[start.index] = 0;
        recycle(pool, job);
        list_push(&pool->finished, job);
        pool->pending--;
        pthread_cond_broadcast(&pool->work);
        pthread_mutex_unlock(&pool->mutex);
        pool->done(pool->context);
        pthread_mutex_lock(&pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

static bool start_worker(struct encode_pool *pool, struct error *err)
{
    unsigned index = pool->thread_count;
    struct worker_start *start = malloc(sizeof *start);
    if (!start)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for encoder threads");
    *start = (struct worker_start){pool, index};
    if (!(pool->jpeg[index] = jpeg_encoder_create(err)))
        goto free_start;
    /* next_job() reads the count: the workers already started must not see it change under them. */
    pthread_mutex_lock(&pool->mutex);
    int failure = pthread_create(&pool->threads[index], NULL, worker_main, start);
    if (!failure)
        pool->thread_count++;
    pthread_mutex_unlock(&pool->mutex);
    if (!failure)
        return true;
    error_set(err, ERROR_TRY_AGAIN, NULL, "cannot start an encoder thread: %s", strerror(failure));
    jpeg_encoder_destroy(pool->jpeg[index]);
free_start:
    free(start);
    return false;
}

struct encode_pool *encode_pool_create(unsigned threads, void (*done)(void *context), void *context, struct error *err)
{
    assert(threads >= 1);
    struct encode_pool *pool = calloc(1, sizeof *pool);
    if (!pool) {
        error_set(err, ERROR_TRY_AGAIN, NULL, "out of memory for encoder threads");
        return NULL;
    }
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->work, NULL);
    pool->queue.end = &pool->queue.first;
    pool->finished.end = &pool->finished.first;
    pool->done = done;
    pool->context = context;
    for (unsigned i = 0; i < threads && i < ENCODERS_MAX; i++)
        if (!start_worker(pool, err)) {
            encode_pool_destroy(pool);
            return NULL;
        }
    return pool;
}

void encode_pool_stop(struct encode_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->mutex);
    unsigned count = pool->thread_count;
    for (unsigned i = 0; i < count; i++) {
        pthread_join(pool->threads[i], NULL);
        jpeg_encoder_destroy(pool->jpeg[i]);
    }
    pool->thread_count = 0;
    while (pool->queue.first) {
        struct encode_job *job = list_remove(&pool->queue, &pool->queue.first);
        error_set(&job->err, ERROR_TRY_AGAIN, NULL, "the server is shutting down");
        list_push(&pool->finished, job);
    }
}

void encode_pool_destroy(struct encode_pool *pool)
{
    if (!pool)
        return;
    encode_pool_stop(pool);
    for (struct encode_job *job = encode_pool_take(pool), *next; job; job = next) {
        next = job->link;
        encode_job_destroy(job);
    }
    for (size_t i = 0; i < SPARE_BUFFERS; i++)
        free(pool->spare[i].data);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->mutex);
    free(pool);
}

void encode_pool_submit(struct encode_pool *pool, struct encode_job *job)
{
    pthread_mutex_lock(&pool->mutex);
    list_push(&pool->queue, job);
    pool->pending++;
    pthread_cond_signal(&pool->work);
    pthread_mutex_unlock(&pool->mutex);
}

void encode_pool_return(struct encode_pool *pool, struct encode_job *job)
{
    pthread_mutex_lock(&pool->mutex);
    list_push(&pool->finished, job);
    pthread_mutex_unlock(&pool->mutex);
    pool->done(pool->context);
}

void encode_pool_fail(struct encode_pool *pool, struct encode_job *job)
{
    assert(job->err.code != ERROR_NONE);
    encode_pool_return(pool, job);
}

size_t encode_pool_pending(struct encode_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    size_t pending = pool->pending;
    pthread_mutex_unlock(&pool->mutex);
    return pending;
}

struct encode_job *encode_pool_take(struct encode_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    struct encode_job *first = pool->finished.first;
    pool->finished.first = NULL;
    pool->finished.end = &pool->finished.first;
    pthread_mutex_unlock(&pool->mutex);
    return first;
}
