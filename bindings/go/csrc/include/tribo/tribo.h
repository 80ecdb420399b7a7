/**
 * @file tribo.h
 * Everything in libtribo_core.
 */
#ifndef TRIBO_TRIBO_H
#define TRIBO_TRIBO_H

#include <tribo/audit.h>
#include <tribo/base.h>
#include <tribo/batch.h>
#include <tribo/body.h>
#include <tribo/contact.h>
#include <tribo/material.h>
#include <tribo/math.h>
#include <tribo/system.h>

#endif
