/* Writes the log of a physics engine for `truebreak diff`: JSON lines, format truebreak/log-1. C99 or C++, no
   dependency. Every call of a step adds to that step's line:

       tb_log *log = tb_open("run.jsonl", "my engine 1.2", "x,y,angle,vx,vy,spin", 53);
       for (long k = 0; k < steps; k++) {
           tb_step(log, k, k * dt);                  // begins step k; the line before is finished
           tb_input(log, "jump");                    // what was fed in, if anything was
           tb_contact(log, "ball", "floor");         // for each pair that was given an impulse
           tb_state(log, "ball", numbers, 6);        // for each body, or for those in contact
           tb_number(log, "energy", energy);         // anything else, by its name
           tb_hash(log, &world, sizeof world);       // or tb_hash_value, of a hash that there is already
       }
       tb_close(log);                                // 0, or -1 if anything could not be written

   A log may be NULL (nothing is written), so that logging can be switched off. Not for several threads at once. */
#ifndef TRUEBREAK_LOG_H
#define TRUEBREAK_LOG_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#define TB_UNUSED __attribute__((unused))
#else
#define TB_UNUSED
#endif

typedef struct { FILE *file; long step; double time; int open, part, parts, seen, digits; } tb_log;

TB_UNUSED static void tb_text(FILE *file, const char *text) {
    fputc('"', file);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\') fprintf(file, "\\%c", *c);
        else if (*c < 32) fprintf(file, "\\u%04x", *c);
        else fputc(*c, file);
    }
    fputc('"', file);
}

/* 17 digits give a double back to the last bit, 9 a float; a locale's comma becomes a point. */
TB_UNUSED static void tb_double(tb_log *log, double value) {
    char text[40];
    snprintf(text, sizeof text, "%.*g", log->digits, value);
    for (char *c = text; *c; c++) if (*c == ',') *c = '.';
    fputs(isnan(value) ? "NaN" : isinf(value) ? (value < 0 ? "-Infinity" : "Infinity") : text, log->file);
}

TB_UNUSED static void tb_begin(tb_log *log) {
    int digits = log->digits;
    fprintf(log->file, "{\"step\": %ld, \"time\": ", log->step);
    log->digits = 17, tb_double(log, log->time), log->digits = digits;
    log->open = 1, log->part = log->seen = 0;
}

TB_UNUSED static void tb_end_part(tb_log *log) {
    if (log->part) fputc(log->part == 1 ? ']' : '}', log->file);
    log->part = 0;
}

TB_UNUSED static void tb_finish(tb_log *log) {
    if (log->open) tb_end_part(log), fputs("}\n", log->file), log->open = 0;
}

/* Goes on with the list of contacts (1) or states (2); one that was ended goes on in a new line of the same step. */
TB_UNUSED static void tb_part(tb_log *log, int part) {
    if (log->part == part) { fputs(", ", log->file); return; }
    tb_end_part(log);
    if (log->seen & part) tb_finish(log), tb_begin(log);
    fputs(part == 1 ? ", \"contacts\": [" : ", \"states\": {", log->file);
    log->part = part, log->seen |= part;
}

TB_UNUSED static void tb_key(tb_log *log, const char *name) {
    tb_end_part(log);
    fputs(", ", log->file), tb_text(log->file, name), fputs(": ", log->file);
}

/* Opens a log; fields: names of the numbers of a state, with commas between; bits: 24 for float, 53 for double.
   NULL if the file cannot be written. */
TB_UNUSED static tb_log *tb_open(const char *path, const char *engine, const char *fields, int bits) {
    tb_log *log = (tb_log *)calloc(1, sizeof(tb_log));
    if (!log) return NULL;
    log->file = fopen(path, "w"), log->digits = bits <= 24 ? 9 : 17;
    if (!log->file) { free(log); return NULL; }
    fputs("{\"log\": \"truebreak/log-1\", \"engine\": ", log->file);
    tb_text(log->file, engine);
    fprintf(log->file, ", \"bits\": %d, \"fields\": [", bits);
    while (*fields) {
        size_t n = strcspn(fields, ",");
        fprintf(log->file, "\"%.*s\"%s", (int)n, fields, fields[n] ? ", " : "");
        fields += n + (fields[n] == ',');
    }
    fputs("]}\n", log->file);
    return log;
}

TB_UNUSED static void tb_step(tb_log *log, long step, double time) {
    if (log) tb_finish(log), log->step = step, log->time = time, tb_begin(log);
}

TB_UNUSED static void tb_contact(tb_log *log, const char *a, const char *b) {
    if (!log) return;
    tb_part(log, 1);
    fputc('[', log->file), tb_text(log->file, a), fputs(", ", log->file), tb_text(log->file, b), fputc(']', log->file);
}

TB_UNUSED static void tb_state(tb_log *log, const char *body, const double *numbers, int count) {
    if (!log) return;
    tb_part(log, 2);
    tb_text(log->file, body), fputs(": [", log->file);
    for (int k = 0; k < count; k++) fputs(k ? ", " : "", log->file), tb_double(log, numbers[k]);
    fputc(']', log->file);
}

TB_UNUSED static void tb_number(tb_log *log, const char *name, double value) {
    if (log) tb_key(log, name), tb_double(log, value);
}

TB_UNUSED static void tb_input(tb_log *log, const char *input) {
    if (log) tb_key(log, "input"), tb_text(log->file, input);
}

TB_UNUSED static void tb_hash_value(tb_log *log, uint64_t hash) {
    if (log) tb_key(log, "hash"), fprintf(log->file, "\"%016llx\"", (unsigned long long)hash);
}

/* FNV-1a of the bytes. Padding is among them: set a struct to zero before it is filled. */
TB_UNUSED static void tb_hash(tb_log *log, const void *bytes, size_t count) {
    uint64_t hash = 14695981039346656037ull;
    for (const unsigned char *c = (const unsigned char *)bytes; count--; c++) hash = (hash ^ *c) * 1099511628211ull;
    tb_hash_value(log, hash);
}

/* Finishes the log: 0, or -1 if something could not be written. */
TB_UNUSED static int tb_close(tb_log *log) {
    int failed;
    if (!log) return 0;
    tb_finish(log);
    failed = ferror(log->file);
    failed |= fclose(log->file);
    free(log);
    return failed ? -1 : 0;
}

#endif
