/**
 * @file channel.h
 * Files without a name for readers of the program, and what they say on standard error.
 */
#ifndef FUZZ_CHANNEL_H
#define FUZZ_CHANNEL_H

#include <stddef.h>
#include <stdio.h>

/** A file without a name, and standard error into another while a reader is at work. */
typedef struct channel {
    FILE *input;
    FILE *messages;
    char path[32];      /**< of the file */
    char message[1024]; /**< what was said between begin and end */
    int kept_error;
} channel;

/** The only one. */
channel *channel_get(void);

/** Fill the file, and listen. */
channel *channel_begin(const void *bytes, size_t length);

/** Stop listening. */
void channel_end(channel *p);

/** Whether the message is "tribo: FILE:LINE:COLUMN: text", one line of printable characters. */
int channel_place(const channel *p, unsigned long *line, unsigned long *column);

/** Whether the message is one line "tribo: FILE:... text". */
int channel_said_once(const channel *p);

#endif
