// SPDX-License-Identifier: Apache-2.0
// Appended to ik_root_digit: the root after every row is right, at full width. A linear ghost replaces the square.
// No assumptions: operands are arbitrary in every clock, and the first state is arbitrary.
//
// Ghosts travel with the operand: the radicand M (its 2 ROWS low bits), S and Q. A row computes S <= 4 S + q (4 Q + 1)
// and Q <= 2 Q + q from S = Q = 0. So S = Q^2, as `floors` proves, without a multiplier in this formula. After n rows,
// S + R == M >> 2 (ROWS - n) and 0 <= R <= 2 Q, and the word holds Q and M's remaining bits. R is r if r >= 0, else
// r + 2 Q + 1.

reg [LAT-1:0] f_valid = {LAT{1'b0}};  // bit i: the operand behind i+1 registers entered after the first clock
always @(posedge clk) f_valid <= {f_valid[LAT-2:0], 1'b1};

localparam integer MW = 2 * ROWS;
localparam [MW-1:0] LOW = (1 << (2 * (ROWS - PAIRS))) - 1;  // mask: bits of the radicand that are zeros

(* hierconn *) wire [2*STAGES-1:0] \u_flags.genblk1.genblk1.g_line.line ;

generate
  for (k = 0; k < ROWS; k = k + 1) begin : g_slice
    localparam integer CLOCKS = (BITS == 1 || k % 2 == 1 || k == ROWS - 1) ? 1 : 0;
    localparam integer STAGE = (BITS == 1) ? k : (k / 2);
    localparam integer BEFORE = (STAGE == 0) ? 0 : (STAGE - 1);
    localparam integer NEXT = (k + 1 > PAIRS) ? (k + 1) : (2 * PAIRS - k - 1);
    localparam integer COME = (k + 1 < PAIRS) ? (PAIRS - k - 1) : 0;  // stored pairs not used yet
    wire minus_in;
    wire over_in;
    wire [MW-1:0] M;
    wire [MW-1:0] S;
    wire [ROWS-1:0] Q;
    if (k == 0) begin : g_first
      assign {minus_in, over_in, M} = {n[NW-1], (v >> MW) != 0, v[MW-1:0]};
      assign {S, Q} = 0;
    end else begin : g_next
      assign {minus_in, over_in, M, S, Q} = {
        g_slice[k-1].minus_q, g_slice[k-1].over_q, g_slice[k-1].M_q, g_slice[k-1].S_q, g_slice[k-1].Q_q
      };
    end
    wire bit_q = g_row[k].q_bit;
    wire [MW-1:0] Q_wide = Q;
    wire [MW-1:0] S_next = (S << 2) + (bit_q ? (Q_wide << 2) + 1'b1 : 0);
    wire [ROWS-1:0] Q_next = {Q[ROWS-2:0], bit_q};
    reg minus_q;
    reg over_q;
    reg [MW-1:0] M_q;
    reg [MW-1:0] S_q;
    reg [ROWS-1:0] Q_q;
    if (CLOCKS == 1) begin : g_clocked
      always @(posedge clk) {minus_q, over_q, M_q, S_q, Q_q} <= {minus_in, over_in, M, S_next, Q_next};
    end else begin : g_through
      always @* {minus_q, over_q, M_q, S_q, Q_q} = {minus_in, over_in, M, S_next, Q_next};
    end
    wire [NEXT-1:0] word = g_row[k].word_q;
    wire [NEXT-1:0] word_of_Q = Q_q;
    wire [NEXT-1:0] word_to_come = (COME > 0) ? ((M_q >> (2 * (ROWS - PAIRS))) << (k + 1)) : 0;
    // r is negative if bit 0 of the word is 0; then r = r_q - 2^(k+2), R = r + 2 Q + 1, and a carry in r_q + 2 Q + 1
    // means R >= 0.
    wire ge = word[0];
    wire [MW:0] Q_twice = {Q_q, 1'b0};
    wire [k+2:0] r_plus = {1'b0, g_row[k].r_q} + {1'b0, ge ? {(k + 2) {1'b0}} : (Q_twice[k+1:0] | 1'b1)};
    wire [MW-1:0] R = r_plus[k+1:0];
    ik_checks u (
        .on(f_valid[STAGE] || (CLOCKS == 0 && (STAGE == 0 || f_valid[BEFORE]))),
        .in_range(R <= Q_twice && r_plus[k+2] == !ge && (Q_q >> (k + 1)) == 0),
        .identity(S_q + R == M_q >> (2 * (ROWS - 1 - k))),
        .to_come((M_q & LOW) == 0 && (CLOCKS == 0 || \u_flags.genblk1.genblk1.g_line.line [2*STAGE+:2] == {minus_q,
            over_q})),
        .result(word == (word_of_Q | word_to_come))
    );
  end
endgenerate

wire signed [XW-1:0] f_n = n;
wire signed [XW-1:0] f_N = f_n <<< SH;
wire f_minus = g_slice[ROWS-1].minus_q;
wire [QW-1:0] f_largest = {1'b0, {(QW - 1) {1'b1}}};
wire [QW-1:0] f_Q_rows = g_slice[ROWS-1].Q_q;
reg [QW:0] f_out;  // expected content of the register behind the rows
always @(posedge clk) f_out <= {f_minus, f_minus ? {QW{1'b0}} : g_slice[ROWS-1].over_q ? f_largest : f_Q_rows};
always @* begin
  one_behind : assert (LAT == STAGES + 1);
  radicand : assert (n[NW-1] || v == f_N);
  if (f_valid[STAGES]) output_root : assert ({neg, q} == f_out);
end

// ---- covers ----

always @* if (f_valid[STAGES]) begin
  fits : cover (!neg && q != 0);
  negative : cover (neg);
end

`ifdef IK_COVER
// A single path, so that the search has no choices: these radicands, one after the other.
reg f_clock = 1'b0;
always @(posedge clk) f_clock <= !f_clock;
wire [NW-1:0] f_n_is = f_clock ? -12345 : 12345;
always @* assume (n == f_n_is);
`endif
