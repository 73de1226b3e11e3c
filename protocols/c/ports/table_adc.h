/* A converter without hardware: counts of hits from a table, at the times a clock says. */
#ifndef ARMODAL_TABLE_ADC_H
#define ARMODAL_TABLE_ADC_H

#include <stdbool.h>
#include <stdint.h>

/* Whether more samples wait than one reading takes: the program should not rest now. */
bool table_adc_behind(void);

/* What a port gives: a clock that never runs backwards, and what it counts in a second, a multiple
   of a million. */
uint64_t table_clock(void);
uint32_t table_clock_hz(void);

#endif
