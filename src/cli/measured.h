/**
 * @file measured.h
 * The part of the demonstration that needs the measured tosses and the recorded contact problems.
 */
#ifndef TRIBO_CLI_MEASURED_H
#define TRIBO_CLI_MEASURED_H

/** Print the errors of the tosses under each law and the solutions of the problems of one contact,
 * from the folder `data`; 0 or an exit status after a message. */
int measured_run(const char *data);

#endif
