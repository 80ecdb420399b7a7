/* Replay inputs: every file of the folders given, and every file given; TAP on standard output.
 *
 *   ROOM-replay FOLDER|FILE...
 *
 * The same bytes go to the same property as in the fuzzing engines. */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "../support/property.h"

enum { LONGEST = 1 << 20 };

static uint8_t bytes[LONGEST];
static unsigned long seen;
static unsigned long failed;

static void replay(const char *path)
{
    property_trial t;
    FILE *file = fopen(path, "rb");
    const size_t size = file != NULL ? fread(bytes, 1, sizeof bytes, file) : 0;
    const int complete = file != NULL && !ferror(file) && feof(file);
    if (file != NULL) {
        fclose(file);
    }
    seen++;
    if (!complete) {
        failed++;
        printf("not ok %lu - %s\n# cannot be read, or is too long\n", seen, path);
        return;
    }
    if (!property_run(&t, bytes, size, NULL)) {
        failed++;
        printf("not ok %lu - %s\n# names no property\n", seen, path);
        return;
    }
    failed += t.expression != NULL;
    printf("%sok %lu - %s: %s%s\n", t.expression != NULL ? "not " : "", seen,
           property_list[bytes[0]].name, path, t.skipped ? " (not exercised)" : "");
    if (t.expression != NULL) {
        property_run(&t, bytes, size, stdout);
        printf("# %s:%d: %s%s\n", t.file, t.line, t.expression, t.detail);
    }
    fflush(stdout);
}

static int visible(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

static void replay_folder(const char *folder)
{
    struct dirent **entries;
    const int count = scandir(folder, &entries, visible, alphasort);
    if (count < 0) {
        replay(folder);
        return;
    }
    for (int i = 0; i < count; i++) {
        const size_t length = strlen(folder) + strlen(entries[i]->d_name) + 2;
        char *path = malloc(length);
        if (path != NULL) {
            snprintf(path, length, "%s/%s", folder, entries[i]->d_name);
            replay(path);
        }
        free(path);
        free(entries[i]);
    }
    free(entries);
}

int main(int argc, char **argv)
{
    printf("# %s\n", property_room);
    for (int i = 1; i < argc; i++) {
        replay_folder(argv[i]);
    }
    printf("1..%lu\n", seen);
    if (seen == 0) {
        printf("# nothing to replay\n");
        return 1;
    }
    return failed != 0;
}
