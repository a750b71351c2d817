/* Frames, commands and tip files of a fingertip or a hand, in C99: no memory is allocated, nothing of the C library is called.
 *
 * Bytes from the board go to ft_push one at a time; at the end of a frame it fills an ft_frame. Commands are written by
 * ft_command (one fingertip, version 2) and ft_hand_command (a hand, version 3). ft_tip_read reads a tip file.
 * The layouts and what every code means: src/link/PROTOCOL.md and model-tables/src/block/LAYOUT.md. */
#ifndef FINGERTIP_H
#define FINGERTIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FT_MAX_BODY 240u  /* bytes of the longest body, in either direction */
#define FT_MAX_FRAME 244u /* the same on the wire, the closing zero included */
#define FT_MAX_TIPS 12u
#define FT_MAX_NAME 64u     /* of a tip file; a frame carries 32 */
#define FT_MAX_BAND 5u      /* rows of a band */
#define FT_MAX_DATA 56u     /* bytes of a tip in one frame */
#define FT_ALL_TIPS 255u    /* of a command to a hand */
#define FT_KEEP_GAIN INT32_MIN /* of a save: the gain that there is */

/* Kinds of frames. */
enum ft_kind {
    FT_READING = 1,  /* version 2 */
    FT_FAULT = 2,    /* version 2 */
    FT_HELLO = 3,    /* of a board; of a hand with the number of its tips */
    FT_ANSWER = 4,   /* of a hand with its tip */
    FT_READINGS = 5, /* version 3: all tips of one instant */
    FT_TIP_HELLO = 6, /* version 3 */
    FT_TIP_DATA = 7,  /* of a hand with its tip */
    FT_BAND = 8       /* of a hand with its tip */
};

/* Kinds of commands. */
enum ft_command_kind {
    FT_TARE = 0x81,
    FT_UNDO = 0x82,
    FT_SAVE = 0x83,
    FT_INFO = 0x84,
    FT_SELF_TEST = 0x85,
    FT_RATE = 0x86,
    FT_FORGET = 0x87,
    FT_OBJECT = 0x88,
    FT_INDENTATION = 0x89,
    FT_AIR = 0x8a,
    FT_ARM = 0x90,
    FT_LOAD_BEGIN = 0x91,
    FT_LOAD_CHUNK = 0x92,
    FT_LOAD_VERIFY = 0x93,
    FT_ACTIVATE = 0x94,
    FT_ROLL_BACK = 0x95,
    FT_READ_BACK = 0x96
};

enum ft_touch { FT_TOUCH_UNKNOWN = 0, FT_UNTOUCHED = 1, FT_TOUCHED = 2 };

/* The values of one fingertip at one instant. */
struct ft_values {
    uint8_t fault;     /* 0: there is a reading; else the reason why not, and the rest is 0 */
    uint8_t touch;     /* enum ft_touch */
    uint16_t warnings; /* one bit each; 0: the reading is ok */
    int32_t rise;      /* counts: see ft_pascals */
    int32_t force_un;
    int32_t indentation_nm;
    int32_t rise_sigma; /* counts; one standard deviation; INT32_MAX: that or more */
    int32_t force_sigma_un;
    int32_t indentation_sigma_nm;
    bool has_feedback; /* of a design with a feedback actuator: its force */
    int32_t feedback_un;
    int32_t feedback_sigma_un;
};

struct ft_hello {
    uint8_t firmware[3]; /* major, minor, patch */
    uint8_t reset_cause;
    uint64_t design_hash; /* of a hand the hand's */
    uint32_t table_version;
    uint32_t report_period_us;
    uint8_t stored;
    uint8_t last_fault;
    uint8_t resets_in_a_row;
    uint32_t last_fault_detail;
    uint32_t stored_number;
    uint32_t samples_lost;
    uint32_t samples_rejected;
    uint32_t frames_dropped;
    uint32_t commands_refused;
    uint8_t tips; /* 0 of a board of one fingertip */
};

struct ft_answer {
    uint8_t tip; /* 0 of a board of one fingertip */
    uint8_t command;
    uint16_t command_sequence;
    uint8_t outcome; /* 0: done */
    uint16_t findings;
    bool has_known; /* of a known indentation: */
    int32_t force_un;
    int32_t force_sigma_un;
    int32_t curvature_per_km;
    int32_t curvature_sigma_per_km;
};

struct ft_tip_hello {
    uint8_t tip;
    uint64_t design_hash;
    uint32_t table_version;
    uint32_t report_period_us;
    uint8_t stored;
    uint32_t stored_number;
    uint32_t samples_rejected;
    char name[33]; /* ends with a zero */
};

struct ft_tip_data {
    uint8_t tip; /* 0 of a board of one fingertip */
    uint16_t command_sequence;
    uint32_t offset;
    uint8_t length;
    uint8_t bytes[FT_MAX_DATA];
};

/* The truth less the reading, tenths of a percent of the reading, lower and upper. */
struct ft_band_row {
    int32_t to; /* the row's last pressure rise, counts */
    int16_t force[2];
    int16_t indentation[2];
};

/* Of a tip that is not told what it touches. It belongs to the hello before it: the next hello, or an answer that an object is done,
 * ends it. */
struct ft_band {
    uint8_t tip; /* 0 of a board of one fingertip */
    uint8_t count; /* rows */
    int32_t from; /* the first pressure rise of which it tells, counts of the frame's fraction bits */
    struct ft_band_row rows[FT_MAX_BAND]; /* rising, one beside the other */
};

struct ft_frame {
    uint8_t version; /* 2: one fingertip; 3: a hand */
    uint8_t kind;    /* enum ft_kind */
    uint16_t sequence;
    uint64_t time_us; /* since reset */
    uint16_t dropped;
    uint8_t fraction_bits; /* k, of a reading, readings or a band: a count is 1 / 2^k pascal */
    uint8_t tips;          /* of readings; 1 of a reading or fault */
    union {
        struct ft_values values[FT_MAX_TIPS]; /* FT_READING, FT_FAULT: the first; FT_READINGS: tips */
        struct ft_hello hello;
        struct ft_answer answer;
        struct ft_tip_hello tip_hello;
        struct ft_tip_data tip_data;
        struct ft_band band;
    } of;
};

enum ft_result {
    FT_NONE,      /* the frame goes on */
    FT_WHOLE,     /* a frame */
    FT_STUFFING,  /* the stuffing is broken, or there are more bytes than any frame has */
    FT_SHORT,     /* fewer bytes than the shortest frame has */
    FT_CRC,       /* the check value does not fit */
    FT_VERSION,   /* another version of the protocol */
    FT_UNKNOWN,   /* no such kind */
    FT_LENGTH,    /* the bytes are not as many as the kind has */
    FT_VALUE      /* a field holds what the layout does not allow */
};

/* Frames out of a stream of bytes; zero it before the first byte. */
struct ft_reader {
    uint8_t bytes[FT_MAX_FRAME];
    uint16_t length;
    bool overflowed;
};

/* Takes the next byte; `frame` is filled where the result is FT_WHOLE. Work is bounded for every byte. */
enum ft_result ft_push(struct ft_reader *reader, uint8_t byte, struct ft_frame *frame);

/* A pressure of a frame in pascals. */
double ft_pascals(int32_t counts, uint8_t fraction_bits);

/* The row of a band, from a frame with `band_bits` fraction bits, for a pressure rise of a frame with `rise_bits`; NULL where the band
 * tells nothing. A reading that is saturated (warning 0), below zero (2) or recovering (9) is a bound, and has no band. */
const struct ft_band_row *ft_band_at(const struct ft_band *band, uint8_t band_bits, int32_t rise, uint8_t rise_bits);

/* The end of a band, in the unit of the value that was read. */
double ft_band_end(int32_t read, int16_t tenths);

/* Writes a command of a board of one fingertip, with its payload as the protocol's page has it; returns the bytes on the wire, 0 for
 * a payload of more than 68 bytes, the most there is. */
size_t ft_command(uint8_t out[FT_MAX_FRAME], uint8_t kind, uint16_t sequence, const uint8_t *payload, size_t length);

/* The same to a tip of a hand, or to FT_ALL_TIPS. */
size_t ft_hand_command(uint8_t out[FT_MAX_FRAME], uint8_t tip, uint8_t kind, uint16_t sequence, const uint8_t *payload,
                       size_t length);

/* A number as a payload has it, little-endian. */
void ft_put_u16(uint8_t out[2], uint16_t number);
void ft_put_i32(uint8_t out[4], int32_t number);

enum ft_tip_result {
    FT_TIP_OK,
    FT_TIP_MAGIC,   /* no tip file */
    FT_TIP_LAYOUT,  /* another layout */
    FT_TIP_SHORT,   /* cut off */
    FT_TIP_CHECK,   /* changed without its CRC-32 */
    FT_TIP_SECTION, /* sections overlap, leave gaps, reach outside, are unknown, or one is missing */
    FT_TIP_FIELD    /* a value out of its range */
};

/* A tip file. Whether its tables never fall is the board's to show when the file is loaded. */
struct ft_tip {
    uint32_t length; /* bytes of the block */
    uint32_t check;
    uint64_t hash; /* of its design */
    uint32_t table_version;
    uint64_t certificate;
    int32_t rest_pressure_pa;
    int32_t maximum_pressure_pa;
    int32_t range_pa[2];
    int32_t resolution_mpa;
    int32_t noise_mpa;
    bool absolute;
    uint8_t transducer; /* 0 ratiometric, 1 ABP2, 2 MS5837-02BA, 3 DPS310 */
    uint8_t address;
    uint8_t fraction_bits;
    int32_t last_rise; /* counts, where the tables end */
    uint32_t table_words;
    char name[FT_MAX_NAME + 1]; /* ends with a zero */
    bool has_calibration;
    int32_t zero_mpa;           /* INT32_MIN: none */
    int32_t zero_temperature;   /* hundredths of a degree Celsius; INT32_MIN: none */
    int32_t zero_mpa_per_kelvin;
    int32_t gain_ppm;
    bool has_relaxation;
    bool has_feedback;
    bool has_object;
    bool has_zero;
};

/* Reads a tip file; more bytes than the block may follow it. */
enum ft_tip_result ft_tip_read(struct ft_tip *tip, const uint8_t *bytes, size_t length);

#ifdef __cplusplus
}
#endif

#endif
