function texts = texts_of(name, value)
%TEXTS_OF  Values as a row of texts: a text or a cell of texts as they are, numbers so that they read back to the same bits.
if iscell(value) && all(cellfun(@(text) ischar(text) || isa(text, 'string') && isscalar(text), value(:)))
    value = cellfun(@char, value, 'UniformOutput', false);  % {"v_out","v_last"} of MATLAB
end
if ischar(value)
    texts = {value};
elseif iscellstr(value) || isa(value, 'string')
    texts = reshape(cellstr(value), 1, []);
elseif isnumeric(value) && isreal(value)
    texts = reshape(arrayfun(@number_text, value, 'UniformOutput', false), 1, []);
else
    error('hertzline:wrongUse', '%s: found a %s, allowed: numbers, a text or a cell of texts', name, class(value));
end
end
