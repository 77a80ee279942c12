/* The members of a JSON object as data: one table drives what is read, what is refused and the sentence that says why.
 * The tables of the protocol are made from proto/gnomon.openrpc.json by the build (protocol.h). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

struct error;

enum member_kind {
    MEMBER_BOOL,    /* bool */
    MEMBER_INTEGER, /* uint64_t */
    MEMBER_NUMBER,  /* double */
    MEMBER_STRING,  /* const char *, borrowed from the object; max: longest, in bytes */
    MEMBER_CHOICE,  /* int: index in `choices` */
    MEMBER_NUMBERS, /* double[count]; min..max each */
    MEMBER_ANY,     /* json_t *, borrowed; whoever uses it checks */
};

/* No integer of a JavaScript client is larger and exact. */
#define MEMBER_INTEGER_MAX 9007199254740991.0

struct member {
    const char *name; /* NULL ends a table */
    enum member_kind kind;
    size_t offset; /* in the struct that is filled */
    double min, max;
    size_t count;               /* MEMBER_NUMBERS */
    const char *const *choices; /* MEMBER_CHOICE; ended by NULL */
    const double *values;       /* MEMBER_INTEGER: what alone is accepted; ended by 0. NULL: min..max */
    unsigned bit;               /* in struct given; 0..63 */
    bool required;
};

/* Which members were there. */
struct given {
    uint64_t bits;
};
static inline bool is_given(struct given given, unsigned index) { return given.bits >> index & 1; }

/* Fills `out` from `object` (NULL counts as {}); members that are absent leave their fields alone and their bit in *given 0. Unknown
 * members are refused naming them all. `where` prefixes names in errors ("camera"), may be "". ERROR_USAGE. */
bool members_read(const json_t *object, const char *where, const struct member *table, void *out, struct given *given,
                  struct error *err);
